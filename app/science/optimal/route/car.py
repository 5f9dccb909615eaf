"""The problem's car as the kernels of a route take it."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.distance.curve import cheapest_speeds
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, Route, WillansDrive
from app.science.optimal.route.stage_kernels import CVT, GEAR, NEUTRAL, WILLANS, Car, Column, Engine

NODES = 2001
LOOKS = 241


def car_of(problem: Route) -> Car:
    """Return the problem's car."""
    engine, gears = problem.engine, problem.transmission
    if isinstance(engine, WillansDrive):
        ways, parts = [_willans(problem, engine)], Engine(np.zeros((1, 1)), np.zeros(0), np.zeros(0), np.zeros(2))
    else:
        line = np.array(engine.full_load, dtype=np.float64).reshape(-1, 2)
        power, curve = curve_of(engine) if gears.kind == "cvt" else (np.zeros(2), np.zeros(2))
        parts = Engine(
            _table(engine), np.ascontiguousarray(line[:, 0]) * RADPS_PER_RPM, np.ascontiguousarray(line[:, 1]), curve
        )
        if gears.kind == "cvt":
            ways = [_variable(problem, engine, power, curve)]
        else:
            ways = [_gear(problem, engine, ratio / problem.load.wheel_radius_m) for ratio in gears.ratios]
    if gears.neutral:
        ways.append(_way(problem, mode=NEUTRAL))
    return Car(np.array(ways, dtype=np.float64), parts)


def _way(problem: Route, **numbers: float) -> Column:
    engine = problem.engine
    idle = engine.willans[0] if isinstance(engine, WillansDrive) else engine.idle_fuel_power_w
    load = problem.load
    common = {
        "idle_w": idle, "brake_n": problem.brake_max_n,
        "accelerated_kg": load.accelerated_mass_kg, "drag_kgpm": load.drag_kgpm,
    }  # fmt: skip
    return Column(**(dict.fromkeys(Column._fields, 0.0) | common | numbers))


def _gear(problem: Route, engine: PolynomialEngine, spd_1pm: float) -> Column:
    low, high = (rpm * RADPS_PER_RPM for rpm in engine.speed_rpm)
    return _way(
        problem, mode=GEAR, spd_1pm=spd_1pm, lowest_radps=low, highest_radps=high,
        lowest_nm=engine.torque_nm[0], highest_nm=engine.torque_nm[1],
    )  # fmt: skip


def _variable(problem: Route, engine: PolynomialEngine, power_w: FloatArray, curve_w: FloatArray) -> Column:
    return _way(
        problem, mode=CVT, least_w=float(power_w[0]), most_w=float(power_w[-1]), least_n=-np.inf, most_n=np.inf,
        step_w=float(power_w[1] - power_w[0]), cheapest_w=float(power_w[curve_w.argmin()]),
    )  # fmt: skip


def _willans(problem: Route, engine: WillansDrive) -> Column:
    (least_w, most_w), (least_n, most_n), (c0, c1, c2) = engine.power_w, engine.force_n, engine.willans
    return _way(
        problem, mode=WILLANS, least_w=least_w, most_w=most_w, least_n=least_n, most_n=most_n, c0=c0, c1=c1, c2=c2
    )


def _table(engine: PolynomialEngine) -> FloatArray:
    table = np.zeros((max(i for i, _ in engine.terms) + 1, max(j for _, j in engine.terms) + 1))
    for (i, j), c in zip(engine.terms, engine.coefficients, strict=True):
        table[i, j] += c
    return table


def curve_of(engine: PolynomialEngine) -> tuple[FloatArray, FloatArray]:
    """Return nodes of an engine's power and the least fuel power there, with its speed free, W."""
    omega = np.linspace(*engine.speed_rpm, LOOKS) * RADPS_PER_RPM
    top = full_load_nm(engine, omega / RADPS_PER_RPM)
    able = top >= engine.torque_nm[0]
    low = float((omega * engine.torque_nm[0])[able].min())
    power = np.linspace(low, float((omega * top)[able].max()), NODES)
    best = engine_speeds(engine, power)
    return power, fuel_power_w(engine, best, power / best)


def engine_speeds(engine: PolynomialEngine, power_w: FloatArray) -> FloatArray:
    """Return the engine speeds that burn least at powers of a CVT, rad/s."""
    return cheapest_speeds(engine, power_w, np.linspace(*engine.speed_rpm, LOOKS) * RADPS_PER_RPM)


def is_geared(car: Car) -> bool:
    """Tell whether the car has gears."""
    return bool(car.columns[0, 0] == GEAR)


def gear_of(column: int, car: Car) -> int:
    """Return the gear of a column as people count: from 1, 0 for neutral and for drives without gears."""
    return column + 1 if car.columns[column, 0] == GEAR else 0


def speed_range_mps(car: Car) -> tuple[float, float]:
    """Return the lowest and highest speed at which some gear can be engaged, m/s."""
    if not is_geared(car):
        return 0.0, np.inf
    gears = [Column(*row) for row in car.columns if row[0] == GEAR]
    return gears[0].lowest_radps / gears[0].spd_1pm, gears[-1].highest_radps / gears[-1].spd_1pm
