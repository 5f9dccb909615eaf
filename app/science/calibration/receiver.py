"""The receiver beside the wheels and the logger's clock: metres per tick, the scale of a speed, latency, skew."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.calibration.blocks import FEWEST_BLOCKS, blocks_of, fit
from app.science.calibration.evidence import Estimate
from app.science.calibration.motion import LONGEST_GAP_S, spacing, speed_by_ticks, within
from app.science.logger.recording import Recording, Series, series
from app.science.roads.projection import LocalPlane
from app.science.vehicle.model import Vehicle

STEP_S = 0.05
BLOCKS_S = (5.0, 30.0)
SLOWEST_MPS = 4.0
LATEST_S = 2.0
COARSE_S = 0.1
ROUNDS = 4
BASELINE_S = 4.0
STEADY_MPS2 = 0.05
MOST_STEPS = 500
CLOCK_BLOCK_S = 60.0
CORNERS_CUT = 0.005
"""Share of the way that straight lines between positions may cut off."""


def receiver_speed(recording: Recording) -> Series | None:
    """Return the receiver's speed: its own, or from its positions over `BASELINE_S`; None without either."""
    told = recording.get("gnss_speed_mps")
    if told is not None:
        return told
    lat, lon = recording.get("lat_deg"), recording.get("lon_deg")
    if lat is None or lon is None or len(lat) < 2:
        return None
    plane = LocalPlane(float(lat.value[0]), float(lon.value[0])).forward(
        lat.value, np.interp(lat.t_s, lon.t_s, lon.value)
    )
    apart = max(round(BASELINE_S / spacing(lat)), 1)
    if len(lat) <= apart:
        return None
    time_s = lat.t_s[apart:] - lat.t_s[:-apart]
    moved = np.hypot(plane.north_m[apart:] - plane.north_m[:-apart], plane.east_m[apart:] - plane.east_m[:-apart])
    good = time_s < 2.0 * BASELINE_S
    return series((lat.t_s[apart:] - 0.5 * time_s)[good], (moved / time_s)[good])


@dataclass(frozen=True, slots=True)
class Wheels:
    """Speed by the wheels and its derivative on a grid, m/s and m/s², arrays of shape (n,); NaN where not known."""

    t_s: FloatArray
    speed_mps: FloatArray
    rising_mps2: FloatArray

    def behind(self, late_s: float, told: Series) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return times, speed, derivative and the receiver's speed, of its samples that can be compared."""
        speed, rising = (np.interp(told.t_s - late_s, self.t_s, one) for one in (self.speed_mps, self.rising_mps2))
        used = np.isfinite(rising) & (speed > SLOWEST_MPS)
        return told.t_s[used], speed[used], rising[used], told.value[used]


def wheels_seen(recording: Recording, vehicle: Vehicle) -> dict[str, Estimate]:
    """Estimate ``metres_per_tick`` or ``speed_scale``, and ``gps_latency``, of `TripEvidence`.

    The receiver's speed is fitted by the wheels' and its derivative: a late receiver shows what was true before. The
    skew of the logger's clock is taken out of ticks, which it times.
    """
    told, wheels = receiver_speed(recording), _wheels(recording, vehicle)
    if told is None or wheels is None:
        return {}
    late = _coarse_latency(wheels, told)
    for _ in range(ROUNDS):
        times, speed, rising, value = wheels.behind(late, told)
        if len(times) < 2:
            return {}
        block = blocks_of(times, float(np.clip((times[-1] - times[0]) / 20.0, *BLOCKS_S)))
        if block[-1] + 1 < FEWEST_BLOCKS or np.std(rising) < STEADY_MPS2:
            return {}
        found = fit(np.column_stack([speed, -rising]), value, block)
        late += float(np.clip(found.value[1] / found.value[0], -0.3, 0.3))
    if abs(late) > LATEST_S:
        return {}
    scale, sd = float(found.value[0]), np.sqrt(np.diag(found.covariance))
    coarse = 0.5 / np.sqrt(3.0) * resolution_mps(recording) / float(np.mean(speed))
    scale_sd = float(np.hypot(sd[0], coarse if "gnss_speed_mps" in recording else CORNERS_CUT))
    result = {"gps_latency": Estimate.of(np.array([late]), np.array([[(sd[1] / scale) ** 2]]))}
    if "vss_tick" not in recording:
        return result | {"speed_scale": Estimate.of(np.array([scale]), np.array([[scale_sd**2]]))}
    metres = vehicle.vss_m_per_tick / (1.0 + 1e-6 * certain_skew(recording))
    seen = Estimate.of(np.array([scale * metres]), np.array([[(scale_sd * metres) ** 2]]))
    return result | {"metres_per_tick": seen}


def resolution_mps(recording: Recording) -> float:
    """Step in which a measured speed is told, m/s, which may be cut off as well as rounded; 0 for ticks."""
    if "vss_tick" in recording:
        return 0.0
    told = np.unique(recording["speed_mps"].value)
    return float(np.diff(told).min()) if 1 < len(told) < MOST_STEPS else 0.0


def _wheels(recording: Recording, vehicle: Vehicle) -> Wheels | None:
    own = recording.get("vss_tick" if "vss_tick" in recording else "speed_mps")
    if own is None or len(own) < 3:
        return None
    t = np.arange(own.t_s[0], own.t_s[-1], STEP_S)
    if "vss_tick" in recording:
        speed, known = speed_by_ticks(own, vehicle.vss_m_per_tick, t)
    else:
        speed, known = np.interp(t, own.t_s, own.value), within(own, t, min(LONGEST_GAP_S, 2.5 * spacing(own)))
    if np.count_nonzero(known) < 2:
        return None
    speed = np.where(known, speed, np.nan)
    return Wheels(t, speed, np.gradient(speed, STEP_S))


def _coarse_latency(wheels: Wheels, told: Series) -> float:
    """Latency, to a tenth of a second, at which the two speeds are most alike."""
    best, least = 0.0, np.inf
    for late in np.arange(-LATEST_S, LATEST_S + COARSE_S, COARSE_S):
        _, speed, _, value = wheels.behind(float(late), told)
        if len(speed):
            scale = float(value @ speed / (speed @ speed))
            apart = float(np.median(np.abs(value - scale * speed)))
            best, least = (float(late), apart) if apart < least else (best, least)
    return best


def clock_seen(recording: Recording) -> Estimate | None:
    """Estimate ``clock_skew`` of `TripEvidence`; None where UTC was not told for long enough."""
    utc = recording.get("utc_s")
    if utc is None or len(utc) < 3:
        return None
    block = blocks_of(utc.t_s, CLOCK_BLOCK_S)
    if block[-1] + 1 < FEWEST_BLOCKS:
        return None
    since = utc.value - utc.value[0]
    middle = np.mean(since)
    ahead = utc.t_s - since
    found = fit(np.column_stack([np.ones(len(since)), since - middle]), ahead - np.median(ahead), block)
    rounding = 1e-3 / max(float(since[-1]), 1.0)
    return Estimate.of(found.value[1:] * 1e6, (found.covariance[1:, 1:] + rounding**2) * 1e12)


def certain_skew(recording: Recording) -> float:
    """Millionths that the logger's clock certainly runs fast; 0 where it is not known to."""
    seen = clock_seen(recording)
    return seen.value[0] if seen is not None and abs(seen.value[0]) > 3.0 * seen.sd[0] else 0.0
