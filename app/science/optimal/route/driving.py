"""A drive by stages as rows over time: what the engine and the brakes do, and what it burns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.answer import Trajectory
from app.science.optimal.fuel_checks import fuel_power_w
from app.science.optimal.problem import Route, WillansDrive
from app.science.optimal.route.car import engine_speeds, gear_of, is_geared
from app.science.optimal.route.stage_kernels import NEUTRAL, Car, Column
from app.science.optimal.route.stages import Stages

SHOWN = np.array([0.0, 0.5, 1.0])
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True, slots=True)
class Driven:
    """A drive by stages, told exactly.

    Attributes
    ----------
    trajectory : Trajectory
        Begin, middle and end of each stage, so a time comes twice between two.
    fuel_j, time_s : float
    """

    trajectory: Trajectory
    fuel_j: float
    time_s: float


@dataclass(frozen=True, slots=True)
class Work:
    """What engine and brakes do, each array of the same shape; NaN engine speed and torque where they aren't known."""

    engine_speed_radps: FloatArray
    torque_nm: FloatArray
    fuel_power_w: FloatArray
    brake_n: FloatArray


def driven(problem: Route, stages: Stages, car: Car, speed_mps: FloatArray, column: IntArray) -> Driven:
    """Return a drive with steady acceleration in each stage.

    Parameters
    ----------
    problem, stages, car
    speed_mps : array, shape (n + 1,)
    column : int array, shape (n,)
    """
    begin, end = speed_mps[:-1, None], speed_mps[1:, None]
    seconds = 2.0 * stages.length_m[:, None] / (begin + end)
    starts = np.concatenate(([0.0], np.cumsum(seconds[:, 0])))[:-1, None]

    def rows(share: FloatArray) -> tuple[FloatArray, Work]:
        v = begin + (end - begin) * share
        against = problem.load.accelerated_mass_kg * (end - begin) / seconds + stages.grade_n[:, None]
        columns = np.broadcast_to(column[:, None], v.shape)
        return v, work(problem, car, columns, v, against + problem.load.drag_kgpm * v**2)

    shown, doing = rows(SHOWN)
    along = stages.edges_m[:-1, None] + seconds * (begin * SHOWN + 0.5 * (end - begin) * SHOWN**2)
    along[:, -1] = stages.edges_m[1:]
    gears = np.array([gear_of(int(one), car) for one in column])
    trajectory = Trajectory(
        t_s=(starts + seconds * SHOWN).ravel(),
        distance_m=along.ravel(),
        speed_mps=shown.ravel(),
        gear=np.repeat(gears, len(SHOWN)),
        engine_speed_radps=doing.engine_speed_radps.ravel(),
        torque_nm=doing.torque_nm.ravel(),
        fuel_power_w=doing.fuel_power_w.ravel(),
        brake_n=doing.brake_n.ravel(),
    )
    _, inner = rows(0.5 * (GAUSS + 1.0))
    fuel = float((seconds * 0.5 * WEIGHTS * inner.fuel_power_w).sum())
    return Driven(trajectory, fuel, float(seconds.sum()))


def work(problem: Route, car: Car, column: IntArray, v: FloatArray, force_n: FloatArray) -> Work:
    """Return what engine and brakes do for a force at the wheels in a column at a speed, arrays of one shape."""
    none = np.full(v.shape, np.nan)
    first = Column(*car.columns[0])
    rolls = car.columns[column, 0] == NEUTRAL
    engine = problem.engine
    if isinstance(engine, WillansDrive):
        least_n = np.where(v > 0.0, first.least_w / np.where(v > 0.0, v, 1.0), -np.inf)
        pull = np.where(rolls, 0.0, np.maximum(force_n, np.maximum(least_n, first.least_n)))
        power = np.maximum(pull * v, 0.0)
        fuel = np.where(rolls, first.idle_w, first.c0 + first.c1 * power + first.c2 * power**2)
        return Work(none, none, fuel, np.maximum(pull - force_n, 0.0))
    if is_geared(car):
        spd = np.where(rolls, np.nan, car.columns[column, Column._fields.index("spd_1pm")])
        omega, torque = spd * v, force_n / spd
        fuel = np.where(rolls, first.idle_w, fuel_power_w(engine, omega, torque))
        return Work(omega, torque, fuel, np.where(rolls, np.maximum(-force_n, 0.0), 0.0))
    asked = force_n * v
    given = np.maximum(asked, np.minimum((force_n + first.brake_n) * v, first.cheapest_w))
    omega = np.where(rolls, np.nan, engine_speeds(engine, given.ravel()).reshape(v.shape))
    fuel = np.where(rolls, first.idle_w, fuel_power_w(engine, omega, given / omega))
    held = np.where(rolls, -force_n, (given - asked) / np.where(v > 0.0, v, 1.0))
    return Work(omega, given / omega, fuel, np.maximum(held, 0.0))
