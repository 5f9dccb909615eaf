"""Steady stretches of about two seconds: what the car's road load, and later its health, are read from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import IntEnum
from itertools import pairwise

import numpy as np

from app.science.arrays import AnyArray, BoolArray, FloatArray, IntArray
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

WINDOW_S = 2.0
SHORTEST_S = 0.8
SETTLE_S = 0.5
"""Left out on either side of a change of regime: the smoother spreads a jump of thrust over about so long."""
LOWEST_SPEED_MPS = 3.0
NO_FUEL_W = 1000.0
"""A burning engine needs more to turn itself; the observer takes a moment to forget the last pulse."""
SELDOM_S = 2.0
"""A signal that comes more seldom does not tell the mean over a window."""


class Regime(IntEnum):
    """What pushes or drags the car."""

    OTHER = 0
    DRIVE = 1
    COAST = 2
    OVERRUN = 3


@dataclass(frozen=True, slots=True)
class RoadLoadWindows:
    """Windows of one trip, arrays of shape (n,) in the order of time.

    Over each window M_a v' + M g sin θ = F − D v² − C_rr M (g cos θ + S_k v²) (Sebesta 2010, 1.4); the left side over
    M is ``specific_force_mps2``, and it owes next to nothing to the road load the observer assumed.

    Attributes
    ----------
    t_s, length_s : array
        Middle and length.
    kind : array of int8
        `Regime`: 1 the engine burns fuel in gear, or may do so where its fuel is not known, 2 it idles with an open
        clutch while the car rolls, 3 in gear without fuel.
    gear : array of int8
        0 with an open clutch, or where the car's gears are not known.
    speed_mps, speed_squared_m2ps2 : array
        Means.
    normal_mps2 : array
        Mean of g cos θ + S_k v², what the tyres carry per kilogram.
    slope : array
        Mean of sin θ.
    acceleration_mps2 : array
    engine_speed_radps, fuel_power_w : array
        Means; NaN where not known, or told too seldom for a mean over two seconds.
    torque_nm : array
        Mean of what the engine control unit reports; NaN without.
    specific_force_mps2, specific_force_sd_mps2 : array
        Mean of M_a/M v' + g sin θ and the observer's standard deviation of it; errors of neighbours are correlated.
    thrust_n : array
        The observer's own, with the road load it assumed.
    mass_kg, drag_area_kgpm, crr, gravity_mps2 : float
        Assumed by the observer; the drag area is ½ ρ C_d A.
    bias_sd_mps2 : float
        Standard deviation of the accelerometer's forward bias, constant over the trip; NaN where there is none.
    """

    t_s: FloatArray
    length_s: FloatArray
    kind: AnyArray
    gear: AnyArray
    speed_mps: FloatArray
    speed_squared_m2ps2: FloatArray
    normal_mps2: FloatArray
    slope: FloatArray
    acceleration_mps2: FloatArray
    engine_speed_radps: FloatArray
    fuel_power_w: FloatArray
    torque_nm: FloatArray
    specific_force_mps2: FloatArray
    specific_force_sd_mps2: FloatArray
    thrust_n: FloatArray
    mass_kg: float
    drag_area_kgpm: float
    crr: float
    gravity_mps2: float
    bias_sd_mps2: float

    def __len__(self) -> int:
        return len(self.t_s)

    def where(self, chosen: BoolArray) -> RoadLoadWindows:
        """Return only the chosen windows, (n,)."""
        return RoadLoadWindows(
            **{name: getattr(self, name)[chosen] for name in WINDOW_COLUMNS},
            **{name: getattr(self, name) for name in WINDOW_SCALARS},
        )


WINDOW_SCALARS = ("mass_kg", "drag_area_kgpm", "crr", "gravity_mps2", "bias_sd_mps2")
WINDOW_COLUMNS = tuple(field.name for field in fields(RoadLoadWindows) if field.name not in WINDOW_SCALARS)


def windows(observation: Observation, vehicle: Vehicle, recording: Recording | None = None) -> RoadLoadWindows:
    """Cut a trip into windows, and leave out what lies near a change of gear or of regime.

    Parameters
    ----------
    observation : Observation
    vehicle : Vehicle
        As the observation was made with.
    recording : Recording, optional
        For the torque that an engine control unit reports.

    Returns
    -------
    RoadLoadWindows
        Possibly empty.
    """
    c = observation.columns
    regime, gear = _regimes(observation, vehicle)
    starts, ends = _pieces(c["t_s"], regime, gear)
    last = ends - 1
    length = c["t_s"][last] - c["t_s"][starts]
    kind, of_gear = regime[starts], gear[starts]
    masses = np.array([vehicle.accelerated_mass_kg(one) for one in range(len(vehicle.gear_ratios) + 1)])
    speed, pitch = c["speed_mps"], c["pitch_rad"]
    slope = _means(np.sin(pitch), starts, ends)
    acceleration = (speed[last] - speed[starts]) / length
    gravity, mass = vehicle.gravity_mps2, vehicle.mass_kg
    return RoadLoadWindows(
        t_s=0.5 * (c["t_s"][starts] + c["t_s"][last]),
        length_s=length,
        kind=kind.astype(np.int8),
        gear=of_gear.astype(np.int8),
        speed_mps=_means(speed, starts, ends),
        speed_squared_m2ps2=_means(speed**2, starts, ends),
        normal_mps2=_means(gravity * np.cos(pitch) + c["curvature_v_radpm"] * speed**2, starts, ends),
        slope=slope,
        acceleration_mps2=acceleration,
        engine_speed_radps=_means(_often(c, "engine_speed_radps", recording, "engine_speed_rpm"), starts, ends),
        fuel_power_w=_means(_often(c, "fuel_power_w", recording, "fuel_rate_lph"), starts, ends),
        torque_nm=_means(_reported_torque(c["t_s"], recording), starts, ends),
        specific_force_mps2=masses[of_gear] / mass * acceleration + gravity * slope,
        specific_force_sd_mps2=_means(c["thrust_n_sd"], starts, ends) / mass,
        thrust_n=_means(c["thrust_n"], starts, ends),
        mass_kg=mass,
        drag_area_kgpm=vehicle.drag_area_kgpm,
        crr=vehicle.crr,
        gravity_mps2=gravity,
        bias_sd_mps2=float(c["bias_i_mps2_sd"][-1]) if len(c["t_s"]) else float("nan"),
    )


def _regimes(observation: Observation, vehicle: Vehicle) -> tuple[IntArray, IntArray]:
    """Return the regime and the gear at each node; a car whose gears are not known is always in gear.

    Without fuel an engine that the wheels didn't turn would stop, so that the car is in gear then, known or not.
    """
    c = observation.columns
    gear = c["gear"].astype(np.int64) if vehicle.gear_ratios else np.zeros(len(c["t_s"]), np.int64)
    in_gear = gear >= 1 if np.any(gear >= 1) else np.ones(len(gear), np.bool_)
    fuel, thrust_sd = c["fuel_power_w"], c["thrust_n_sd"]
    moves = (c["speed_mps"] > LOWEST_SPEED_MPS) & np.isfinite(thrust_sd)
    regime = np.full(len(gear), Regime.OTHER, np.int64)
    regime[moves & in_gear & ~(fuel <= NO_FUEL_W)] = Regime.DRIVE
    regime[moves & ~in_gear & (fuel > NO_FUEL_W)] = Regime.COAST
    regime[moves & (fuel <= NO_FUEL_W)] = Regime.OVERRUN
    return regime, gear


def _pieces(t_s: FloatArray, regime: IntArray, gear: IntArray) -> tuple[IntArray, IntArray]:
    """Return where each window starts and ends (exclusive)."""
    changes = np.flatnonzero((np.diff(regime) != 0) | (np.diff(gear) != 0)) + 1
    starts: list[int] = []
    ends: list[int] = []
    for begin, end in pairwise([0, *changes.tolist(), len(regime)]):
        if begin == end or regime[begin] == Regime.OTHER:
            continue
        first = int(np.searchsorted(t_s, t_s[begin] + SETTLE_S))
        last = int(np.searchsorted(t_s, t_s[end - 1] - SETTLE_S, side="right")) - 1
        if last <= first or t_s[last] - t_s[first] < SHORTEST_S:
            continue
        count = max(round((t_s[last] - t_s[first]) / WINDOW_S), 1)
        edges = np.linspace(first, last, count + 1).round().astype(np.int64)
        starts.extend(edges[:-1].tolist())
        ends.extend((edges[1:] + 1).tolist())
    return np.array(starts, dtype=np.int64), np.array(ends, dtype=np.int64)


def _means(values: FloatArray, starts: IntArray, ends: IntArray) -> FloatArray:
    """Return the mean of each piece; NaN where a value in it is not known."""
    known = np.isfinite(values)
    sums = np.concatenate(([0.0], np.cumsum(np.where(known, values, 0.0))))
    counts = np.concatenate(([0], np.cumsum(known)))
    mean = (sums[ends] - sums[starts]) / np.maximum(ends - starts, 1)
    return np.where(counts[ends] - counts[starts] == ends - starts, mean, np.nan)


def _often(columns: Mapping[str, FloatArray], state: str, recording: Recording | None, signal: str) -> FloatArray:
    """Return a state; unknown where it comes from a signal that is asked for too seldom."""
    asked = None if recording is None else recording.get(signal)
    if asked is None or len(asked) < 2 or float(np.median(np.diff(asked.t_s))) <= SELDOM_S:
        return columns[state]
    return np.full(len(columns[state]), np.nan)


def _reported_torque(t_s: FloatArray, recording: Recording | None) -> FloatArray:
    torque = None if recording is None else recording.get("engine_torque_nm")
    if torque is None or len(torque) < 2:
        return np.full(len(t_s), np.nan)
    after = np.clip(np.searchsorted(torque.t_s, t_s), 1, len(torque) - 1)
    gap = torque.t_s[after] - torque.t_s[after - 1]
    known = (t_s >= torque.t_s[0]) & (t_s <= torque.t_s[-1]) & (gap <= SELDOM_S)
    return np.where(known, np.interp(t_s, torque.t_s, torque.value), np.nan)
