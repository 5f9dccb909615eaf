"""The problem's car as the kernels of a route take it."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS
from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.distance.curve import cheapest_speeds
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, Route
from app.science.optimal.route.stage_kernels import Car, Curve

NODES = 2001
LOOKS = 241
NO_CURVE = Curve(0.0, 1.0, np.zeros(2), 0.0)


def car_of(problem: Route) -> Car:
    """Return the problem's car."""
    drive = drive_numbers(problem)
    curve = curve_of(problem.engine) if drive.kind == CVT and isinstance(problem.engine, PolynomialEngine) else NO_CURVE
    return Car(drive, curve, len(drive.spd_1pm) + drive.neutral)


def curve_of(engine: PolynomialEngine) -> Curve:
    """Return the least fuel power of an engine over its power, with its speed free."""
    omega = np.linspace(*engine.speed_rpm, LOOKS) * RADPS_PER_RPM
    top = full_load_nm(engine, omega / RADPS_PER_RPM)
    able = top >= engine.torque_nm[0]
    low = float((omega * engine.torque_nm[0])[able].min())
    power = np.linspace(low, float((omega * top)[able].max()), NODES)
    fuel = fuel_power_w(engine, (best := engine_speeds(engine, power)), power / best)
    return Curve(low, float(power[1] - power[0]), fuel, float(power[fuel.argmin()]))


def engine_speeds(engine: PolynomialEngine, power_w: FloatArray) -> FloatArray:
    """Return the engine speeds that burn least at powers of a CVT, rad/s."""
    return cheapest_speeds(engine, power_w, np.linspace(*engine.speed_rpm, LOOKS) * RADPS_PER_RPM)


def column_of(gear: int, car: Car) -> int:
    """Return the column of a gear as people count: from 1, 0 for neutral and for drives without gears."""
    if car.drive.kind == GEARS:
        return gear - 1 if gear else len(car.drive.spd_1pm)
    return 0


def gear_of(column: int, car: Car) -> int:
    """Return the gear of a column as people count."""
    return column + 1 if car.drive.kind == GEARS and column < len(car.drive.spd_1pm) else 0
