"""Idling: how fast the engine turns and what it burns while the car stands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from math import pi, sqrt
from typing import Any

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import Idle
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

RPM_PER_RADPS = 30.0 / pi
STANDING_MPS = 0.3
SETTLED_S = 1.5
TELLING = ("injector_pulse_s", "engine_speed_rpm", "fuel_rate_lph", "maf_gps")
FASTEST = 2.0
"""Above twice the car's idle speed somebody is on the pedal."""
SHORTEST_S = 5.0


@dataclass(frozen=True, slots=True)
class IdleSums:
    """Time integrals over one or more trips' idling; plain, so those of several trips add up.

    Attributes
    ----------
    seconds : float
    rpm, rpm_squared, fuel_power_w, fuel_power_w_squared : float
        Each times seconds.
    """

    seconds: float = 0.0
    rpm: float = 0.0
    rpm_squared: float = 0.0
    fuel_power_w: float = 0.0
    fuel_power_w_squared: float = 0.0

    def to_dict(self) -> dict[str, float]:
        """Return the sums for keeping them as JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, kept: Mapping[str, Any] | None) -> IdleSums:
        """Return what `to_dict` gave; nothing of a trip that an earlier Ponthy observed."""
        return cls(**kept) if kept else cls()


NO_IDLE = IdleSums()


def idling(observation: Observation, recording: Recording, vehicle: Vehicle) -> IdleSums:
    """Sum the moments at which the car stands with its engine running; nothing where engine speed or fuel is unknown.

    The first and the last 1.5 s of each stop are left out: the engine comes down to idle, or is revved up to start.
    Where engine speed or fuel are asked for more rarely, as much is left out as lies between two answers, since what
    is known then reaches over from driving.
    """
    c = observation.columns
    rpm, fuel = c["engine_speed_radps"] * RPM_PER_RADPS, c["fuel_power_w"]
    told = [recording[name] for name in TELLING if len(recording.get(name) or ()) > 1]
    settled_s = max([SETTLED_S, *(float(np.median(np.diff(series.t_s))) for series in told)])
    standing = _inside(c["t_s"], c["speed_mps"] < STANDING_MPS, settled_s)
    running = np.isfinite(rpm) & np.isfinite(fuel) & (fuel > 0.0)
    running &= (rpm > 0.5 * vehicle.idle_rpm) & (rpm < FASTEST * vehicle.idle_rpm)
    at = np.flatnonzero(standing & running)
    step = np.minimum(np.diff(c["t_s"], append=c["t_s"][-1]), 1.0)[at]
    return IdleSums(
        seconds=float(step.sum()),
        rpm=float(step @ rpm[at]),
        rpm_squared=float(step @ rpm[at] ** 2),
        fuel_power_w=float(step @ fuel[at]),
        fuel_power_w_squared=float(step @ fuel[at] ** 2),
    )


def idle_of(trips: Iterable[IdleSums], vehicle: Vehicle) -> Idle | None:
    """Add trips up; None where less than five seconds were seen."""
    parts = list(trips)
    seconds = sum(part.seconds for part in parts)
    if seconds < SHORTEST_S:
        return None
    rpm, fuel = (sum(values) / seconds for values in ([p.rpm for p in parts], [p.fuel_power_w for p in parts]))
    rpm_variance = sum(part.rpm_squared for part in parts) / seconds - rpm**2
    fuel_variance = sum(part.fuel_power_w_squared for part in parts) / seconds - fuel**2
    return Idle(
        rpm=rpm,
        rpm_sd=sqrt(max(rpm_variance, 0.0)),
        fuel_power_w=fuel,
        fuel_power_sd_w=sqrt(max(fuel_variance, 0.0)),
        litres_per_hour=3600.0 * fuel / vehicle.fuel_energy_j_per_l,
        seconds=seconds,
    )


def _inside(t_s: FloatArray, holds: BoolArray, settled_s: float) -> BoolArray:
    """Tell where something holds and does so for the settling time before and after."""
    changes = t_s[1:][np.diff(holds)]
    padded = np.concatenate(([-np.inf], changes, [np.inf]))
    after = np.searchsorted(changes, t_s, side="right")
    return np.asarray(holds & (t_s - padded[after] >= settled_s) & (padded[after + 1] - t_s >= settled_s))
