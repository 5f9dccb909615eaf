"""A car on rollers, or on a level road: what a speed trace asks of its wheels, and when its engine runs."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.errors import ScienceError
from app.science.vehicle.model import Vehicle

STANDING_MPS = 0.3
IDLE_AFTER_S, IDLE_BEFORE_S = 10.0, 20.0
"""What is idled before the engine is switched off, and after it was started again, where nothing tells."""
PARKED_S = 120.0
"""Who stands for longer has parked: no traffic light takes so long."""
NO_FUEL_S = 5.0
"""A standing engine without fuel for so long is off."""


@dataclass(frozen=True, slots=True)
class RoadLoad:
    """What holds a car back: A + B·v + C·v² and its inertia.

    Attributes
    ----------
    accelerated_mass_kg : float
        Mass with the share of what turns.
    a_n, b_npmps, c_npmps2 : float
        Coefficients in N, N/(m/s), N/(m/s)².
    """

    accelerated_mass_kg: float
    a_n: float
    b_npmps: float
    c_npmps2: float

    def __post_init__(self) -> None:
        known = isfinite(self.accelerated_mass_kg + self.a_n + self.b_npmps + self.c_npmps2)
        if not (known and self.accelerated_mass_kg > 0.0 and self.a_n >= 0.0 and self.c_npmps2 >= 0.0):
            raise ScienceError("A road load needs a mass above zero, and neither A nor C below zero.")

    @classmethod
    def of(cls, vehicle: Vehicle) -> RoadLoad:
        """Return the road load that a car's XML describes."""
        rolling = vehicle.mass_kg * vehicle.gravity_mps2 * vehicle.crr
        return cls(vehicle.accelerated_mass_kg(0), rolling, 0.0, vehicle.drag_area_kgpm)


@dataclass(frozen=True, slots=True)
class DrivingCycle:
    """A drive once a second; arrays of shape (n,).

    Attributes
    ----------
    name : str
    speed_mps : ndarray
    fuel_power_w : ndarray or None
        Fuel flow times its heating value; None where nothing measured it.
    """

    name: str
    speed_mps: FloatArray
    fuel_power_w: FloatArray | None = None

    @property
    def distance_m(self) -> float:
        """Length of the drive."""
        return float(self.speed_mps.sum())


def propulsion_n(speed_mps: FloatArray, load: RoadLoad, gaining_share: float = 0.0) -> FloatArray:
    """Return the force at the wheels, below zero where the car is braked; shape (n,), N.

    Parameters
    ----------
    speed_mps : ndarray, shape (n,)
    load : RoadLoad
    gaining_share : float
        What gaining speed asks for beyond the accelerated mass, as a share of it.
    """
    acceleration = np.gradient(speed_mps)
    inertia = load.accelerated_mass_kg * np.where(acceleration > 0.0, 1.0 + gaining_share, 1.0) * acceleration
    resistance = load.a_n + load.b_npmps * speed_mps + load.c_npmps2 * speed_mps**2
    return np.where(speed_mps < STANDING_MPS, 0.0, resistance + inertia)


def engine_runs(cycle: DrivingCycle, *, by_fuel: bool) -> BoolArray:
    """Whether the engine is on, shape (n,).

    Parameters
    ----------
    cycle : DrivingCycle
    by_fuel : bool
        Off is a standing car without fuel flow. Otherwise the speed alone has to tell: an engine is off while the car
        is parked (`PARKED_S`) and once it stands for the last time, but for the idling around that.
    """
    runs = np.ones(len(cycle.speed_mps), dtype=np.bool_)
    standing = cycle.speed_mps < STANDING_MPS
    if by_fuel and cycle.fuel_power_w is not None:
        dry = cycle.fuel_power_w <= 0.1 * _usual(cycle.fuel_power_w)
        for begin, end in stretches(standing & dry):
            if end - begin >= NO_FUEL_S:
                runs[begin:end] = False
        return runs
    for begin, end in stretches(standing):
        off_from = begin if begin == 0 else begin + int(IDLE_AFTER_S)
        if end == len(runs):
            runs[off_from:] = False
        elif end - begin > PARKED_S:
            runs[off_from : end - int(IDLE_BEFORE_S)] = False
    return runs


def stretches(flags: BoolArray) -> list[tuple[int, int]]:
    """Return where flags are set without a break, as (first, one past the last)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return [(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def _usual(fuel_power_w: FloatArray) -> float:
    burning = fuel_power_w[fuel_power_w > 0.0]
    return float(np.median(burning)) if burning.size else 0.0
