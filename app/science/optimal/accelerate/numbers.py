"""The problem's car as compiled code takes it, and the speeds it can have."""

from __future__ import annotations

import numpy as np

from app.science.optimal.accelerate.kernels import CVT, GEARS, WILLANS, DriveNumbers
from app.science.optimal.kernels import engine_numbers
from app.science.optimal.problem import DriveProblem, PolynomialEngine, WillansDrive

NO_ENGINE = PolynomialEngine(((0, 0),), (0.0,), (0.0, 1.0), (0.0, 1.0))
NO_WILLANS = WillansDrive((0.0, 0.0, 0.0), (0.0, 0.0), (0.0, 0.0))


def drive_numbers(problem: DriveProblem) -> DriveNumbers:
    """Return the car as compiled code takes it."""
    load, engine, gears = problem.load, problem.engine, problem.transmission
    willans = engine if isinstance(engine, WillansDrive) else NO_WILLANS
    kind = WILLANS if isinstance(engine, WillansDrive) else GEARS if gears.kind == "gears" else CVT
    return DriveNumbers(
        kind,
        np.array(gears.ratios, dtype=np.float64) / load.wheel_radius_m if kind == GEARS else np.full(1, np.nan),
        engine_numbers(NO_ENGINE if isinstance(engine, WillansDrive) else engine),
        np.array(willans.willans, dtype=np.float64),
        np.array(willans.power_w, dtype=np.float64),
        np.array(willans.force_n, dtype=np.float64),
        float(load.accelerated_mass_kg),
        float(load.drag_kgpm),
        float(load.rolling_n),
        gears.neutral,
        float(willans.willans[0] if isinstance(engine, WillansDrive) else engine.idle_fuel_power_w),
        float(problem.brake_max_n),
    )


def speed_range_mps(drive: DriveNumbers) -> tuple[float, float]:
    """Return the lowest and highest speed at which some gear can be engaged, m/s."""
    if drive.kind != GEARS:
        return 0.0, np.inf
    return (
        float(drive.engine.lowest_radps / drive.spd_1pm.max()),
        float(drive.engine.highest_radps / drive.spd_1pm.min()),
    )
