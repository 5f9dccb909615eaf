"""Which states are told, at speed and at standstill, when sensors are lost (Sebesta 2010, 3.1.2.1, computed)."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.observer.observability.car_system import MEASUREMENTS, TYPICAL, Car, field_of, outputs_of
from app.science.observer.observability.rank import Ranked, balanced, lie_derivatives, ranked
from app.science.observer.states import State

HORIZON_S = 5.0
USUAL_GEAR = 4
"""The gear whose accelerated mass counts; which one it is changes no rank."""

When = Literal["always", "changing", "never"]

SENSORS: dict[str, tuple[str, ...]] = {
    "vss": ("vss",),
    "speed": ("speed",),
    "acc": ("acc_i", "acc_j", "acc_k", "acc_x", "acc_y", "acc_z"),
    "gps": ("gps_north", "gps_east", "gps_altitude"),
    "dem": ("dem_altitude",),
    "fuel": ("fuel_energy", "fuel_power"),
    "engine": ("engine_angle", "engine_speed"),
    "heading": ("heading",),
    "pitch": ("pitch",),
    "yaw_rate": ("yaw_rate",),
    "curvature_h": ("curvature_h",),
    "engine_torque": ("engine_torque",),
}
"""Sensors that can be lost, and the measurements (as in `Innovations`) that go with each."""

SILENT_AT_REST = ("heading", "engine_torque")
"""Measurements that `events` takes from a moving car only."""


def cruising(car: Car, slope: float) -> FloatArray:
    """Return a state of constant speed, straight on, on an even slope: where least is told."""
    x = _engine_running()
    x[State.SPEED], x[State.HEADING], x[State.PITCH] = 20.0, 0.7, slope
    x[State.THRUST] = _thrust_for(x, car, 0.0)
    return x


def winding(car: Car) -> FloatArray:
    """Return a state that speeds up in a bend where the slope changes: whatever can be told is told there."""
    x = _engine_running()
    x[State.SPEED], x[State.HEADING], x[State.PITCH] = 15.0, 0.7, 0.04
    x[State.CURVATURE_H], x[State.CURVATURE_V] = 0.01, 0.002
    x[State.THRUST] = _thrust_for(x, car, 1.5)
    return x


def standing(car: Car) -> FloatArray:
    """Return a state of rest on a slope with the engine idling."""
    x = _engine_running()
    x[State.HEADING], x[State.PITCH] = 0.7, 0.02
    x[State.CURVATURE_H], x[State.CURVATURE_V] = 0.01, 0.002
    x[State.THRUST] = car.mass * car.gravity * np.sin(x[State.PITCH])
    return x


def _engine_running() -> FloatArray:
    x = np.zeros(len(State))
    x[State.FUEL_POWER], x[State.ENGINE_SPEED] = 2e4, 250.0
    return x


def _thrust_for(x: FloatArray, car: Car, acceleration: float) -> float:
    v, pitch = x[State.SPEED], x[State.PITCH]
    rolling = car.crr * car.mass * (car.gravity * np.cos(pitch) + x[State.CURVATURE_V] * v * v)
    resist = car.drag * v * v + rolling + car.mass * car.gravity * np.sin(pitch)
    return float(resist + car.accelerated_mass * acceleration)


def situations(car: Car) -> tuple[FloatArray, ...]:
    """Return the states at which sensors are tested: level and uphill at constant speed, winding, at rest."""
    return cruising(car, 0.0), cruising(car, 0.02), winding(car), standing(car)


@dataclass(frozen=True, slots=True)
class Told:
    """What a set of measurements tells of the 17 states.

    Attributes
    ----------
    steady, changing, standing : boolean array, shape (17,)
        At constant speed straight on, be it level or up a slope; while speed, direction and slope change; at rest.
    gap : float
        The least clear gap between singular values that count and those that don't.
    """

    steady: BoolArray
    changing: BoolArray
    standing: BoolArray
    gap: float

    @property
    def moving(self) -> tuple[When, ...]:
        """For each state, when it is told while the car moves."""
        return tuple(
            "always" if steady else "changing" if changing else "never"
            for steady, changing in zip(self.steady, self.changing, strict=True)
        )


class SensorTest:
    """The rank test for any set of measurements of one car; the derivatives are taken once.

    Parameters
    ----------
    car : Car
    """

    def __init__(self, car: Car) -> None:
        field, outputs = field_of(car), outputs_of(car)
        self._derivatives = [lie_derivatives(field, outputs, x0, TYPICAL, HORIZON_S) for x0 in situations(car)]

    def told(self, measurements: Iterable[str], silent_at_rest: Collection[str] = ()) -> Told:
        """Return what a set of measurements tells, by the names of `MEASUREMENTS`; some may say nothing at rest."""
        wanted = tuple(measurements)
        at_rest = tuple(name for name in wanted if name not in silent_at_rest)
        sets = (wanted, wanted, wanted, at_rest)
        found = [_ranked(one, names) for one, names in zip(self._derivatives, sets, strict=True)]
        level, uphill, winding, standing = found
        gap = min(one.gap for one in found)
        return Told(level.told & uphill.told, winding.told, standing.told, gap)


def _ranked(derivatives: Mapping[str, FloatArray], measurements: Sequence[str]) -> Ranked:
    if not measurements:
        return ranked(np.zeros((1, len(State))))
    return ranked(balanced([derivatives[name] for name in measurements]))


@dataclass(frozen=True, slots=True)
class Loss:
    """What is still told when some sensors are lost; none for the whole set."""

    lost: tuple[str, ...]
    told: Told


def sensors_of(measurements: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return the sensors behind measurements and what is lost with each.

    A heading beside position fixes is the course over ground, which goes with the satellites; alone it is a compass.
    """
    there = tuple(name for name in measurements if name in MEASUREMENTS)
    owned = {sensor: tuple(name for name in own if name in there) for sensor, own in SENSORS.items()}
    if owned["gps"] and owned["heading"]:
        owned["gps"] += owned.pop("heading")
    return {sensor: own for sensor, own in owned.items() if own}


def losses(test: SensorTest, measurements: Iterable[str]) -> tuple[Loss, ...]:
    """Return what is told with every sensor, without each in turn, and without any height.

    At rest the observer takes no heading, since most are courses over ground, and no torque.

    Parameters
    ----------
    test : SensorTest
    measurements : iterable of str
        Names of what is measured, as in `Innovations`; what is no measurement of a state is passed over.
    """
    sensors = sensors_of(measurements)
    sets: list[tuple[str, ...]] = [(), *((sensor,) for sensor in sensors)]
    if {"gps", "dem"} <= set(sensors):
        sets.append(("gps", "dem"))
    whole = set(sensors)
    return tuple(Loss(lost, test.told(_left(sensors, lost), SILENT_AT_REST)) for lost in sets if set(lost) != whole)


def _left(sensors: Mapping[str, Sequence[str]], lost: Sequence[str]) -> list[str]:
    return [name for sensor, own in sensors.items() if sensor not in lost for name in own]
