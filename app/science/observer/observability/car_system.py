"""The car's 17 states and every measurement of them, written for Taylor series (Sebesta 2010, 1.16–1.18)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from app.science.arrays import FloatArray
from app.science.observer.motion_kernels import SIGN_WIDTH_MPS
from app.science.observer.observability.jets import Field, Jet, Output, sine_cosine, tanh
from app.science.observer.observability.linear import own_axes
from app.science.observer.states import State
from app.science.vehicle.model import Vehicle

TYPICAL: FloatArray = np.array(
    [1e3, 15.0, 2e3, 1.8, 0.06, 1e3, 1e3, 100.0, 0.02, 0.002, 1e7, 3e4, 1e4, 200.0, 0.3, 0.3, 0.3]
)
"""What one would say of each state without any sensor: its standard deviation, in the unit of its column.

Half a turn of heading; a hill of 3.5°; bends of 50 m and crests of 500 m; an engine between standing and 2000 rpm; an
accelerometer that is 0.3 m/s² off.
"""


@dataclass(frozen=True, slots=True)
class Car:
    """The car's numbers in one gear, SI units.

    ``turns_per_metre`` is engine radians per metre of road; ``acc_axes`` (3, 3) has a row for each of the
    accelerometer's own axes: where it points, forward, right, down.
    """

    drag: float
    crr: float
    mass: float
    gravity: float
    accelerated_mass: float
    turns_per_metre: float
    acc_axes: FloatArray


Measure: TypeAlias = Callable[[Sequence[Jet], Car], Jet]


def car_in_gear(vehicle: Vehicle, gear: int) -> Car:
    """Return a car's numbers in a gear; in gear 0 engine and wheels have nothing to do with each other."""
    ratio = vehicle.gear_ratios[gear - 1] if 0 < gear <= len(vehicle.gear_ratios) else 0.0
    return Car(
        vehicle.drag_area_kgpm,
        vehicle.crr,
        vehicle.mass_kg,
        vehicle.gravity_mps2,
        vehicle.accelerated_mass_kg(min(gear, len(vehicle.gear_ratios))),
        ratio / vehicle.wheel_radius_m,
        own_axes(vehicle),
    )


def pull(x: Sequence[Jet], car: Car) -> Jet:
    """Return thrust minus drag and rolling resistance (Sebesta 2010, 1.1–1.3, with the M that (1.3) lacks), N."""
    v = x[State.SPEED]
    _, cosine = sine_cosine(x[State.PITCH])
    rolling = car.crr * car.mass * (car.gravity * cosine + x[State.CURVATURE_V] * v * v)
    return x[State.THRUST] - tanh(v * (1.0 / SIGN_WIDTH_MPS)) * (car.drag * v * v + rolling)


def rates(x: Sequence[Jet], car: Car) -> list[Jet]:
    """Return ẋ of all 17 states (Sebesta 2010, 1.16–1.17)."""
    v = x[State.SPEED]
    sin_p, cos_p = sine_cosine(x[State.PITCH])
    sin_h, cos_h = sine_cosine(x[State.HEADING])
    out = [v * 0.0 for _ in State]
    out[State.DISTANCE] = v
    out[State.SPEED] = (pull(x, car) - car.mass * car.gravity * sin_p) * (1.0 / car.accelerated_mass)
    out[State.HEADING] = x[State.CURVATURE_H] * v
    out[State.PITCH] = x[State.CURVATURE_V] * v
    out[State.NORTH] = v * cos_h * cos_p
    out[State.EAST] = v * sin_h * cos_p
    out[State.DOWN] = -(v * sin_p)
    out[State.FUEL_ENERGY] = x[State.FUEL_POWER]
    out[State.ENGINE_ANGLE] = x[State.ENGINE_SPEED]
    return out


def _forwards(x: Sequence[Jet], car: Car) -> Jet:
    sin_p, _ = sine_cosine(x[State.PITCH])
    rest = car.gravity * (1.0 - car.mass / car.accelerated_mass)
    return pull(x, car) * (1.0 / car.accelerated_mass) + rest * sin_p + x[State.BIAS_I]


def _downwards(x: Sequence[Jet], car: Car) -> Jet:
    _, cos_p = sine_cosine(x[State.PITCH])
    v = x[State.SPEED]
    return x[State.BIAS_K] - car.gravity * cos_p - x[State.CURVATURE_V] * v * v


def _sideways(x: Sequence[Jet], _car: Car) -> Jet:
    v = x[State.SPEED]
    return x[State.CURVATURE_H] * v * v + x[State.BIAS_J]


def _along(axis: int) -> Measure:
    def reading(x: Sequence[Jet], car: Car) -> Jet:
        forward, right, down = (float(share) for share in car.acc_axes[axis])
        return forward * _forwards(x, car) + right * _sideways(x, car) + down * _downwards(x, car)

    return reading


def _state(state: State, sign: float = 1.0) -> Measure:
    return lambda x, _car: x[state] * sign


def _turning(x: Sequence[Jet], _car: Car) -> Jet:
    return x[State.CURVATURE_H] * x[State.SPEED]


def _engine_on_wheels(x: Sequence[Jet], car: Car) -> Jet:
    return x[State.ENGINE_SPEED] - car.turns_per_metre * x[State.SPEED]


MEASUREMENTS: dict[str, Measure] = {
    "vss": _state(State.DISTANCE),
    "speed": _state(State.SPEED),
    "standstill": _state(State.SPEED),
    "acc_i": _forwards,
    "acc_j": _sideways,
    "acc_k": _downwards,
    "acc_x": _along(0),
    "acc_y": _along(1),
    "acc_z": _along(2),
    "heading": _state(State.HEADING),
    "pitch": _state(State.PITCH),
    "curvature_h": _state(State.CURVATURE_H),
    "yaw_rate": _turning,
    "gps_north": _state(State.NORTH),
    "gps_east": _state(State.EAST),
    "gps_altitude": _state(State.DOWN, -1.0),
    "dem_altitude": _state(State.DOWN, -1.0),
    "engine_torque": _state(State.THRUST),
    "fuel_energy": _state(State.FUEL_ENERGY),
    "fuel_power": _state(State.FUEL_POWER),
    "engine_angle": _state(State.ENGINE_ANGLE),
    "engine_speed": _state(State.ENGINE_SPEED),
    "gear": _engine_on_wheels,
}
"""What each measurement says, by the names of `Innovations`; ``gear`` is the knowledge that the ratio is known."""


def field_of(car: Car) -> Field:
    """Return the right-hand side of the car's ẋ = f(x)."""
    return lambda x: rates(x, car)


def outputs_of(car: Car) -> dict[str, Output]:
    """Return every measurement of `MEASUREMENTS` as y = h(x)."""
    return {name: _of(measure, car) for name, measure in MEASUREMENTS.items()}


def _of(measure: Measure, car: Car) -> Output:
    return lambda x: measure(x, car)
