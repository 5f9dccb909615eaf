"""Accelerations and routes of the thesis' car, against the same by plain NumPy on grids of controls."""

from __future__ import annotations

from dataclasses import replace

from app.cli.bench.figure import Figure, best_seconds, timed
from app.cli.bench.routes import routes
from app.science.optimal.accelerate.brute_force import least_lagrangian
from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.accelerate.solve import solve
from app.science.optimal.problem import Accelerate, PolynomialEngine, RoadLoad, Transmission

SMART = RoadLoad(920.0, 948.0, 0.39, 1.93, 0.010, 1.2, 9.805, 0.2954)
PHI = (9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04)
RATIOS = (13.25, 9.604, 7.37, 5.796, 4.208, 3.23)
HURRIED = 0.9
IDLE_W = 6000.0
REPEATS = 20


def measure() -> list[Figure]:
    """Return the times of one solution each, accelerations in free time and in nine tenths of it, and routes."""
    engine = PolynomialEngine.of_phi(PHI, (1000.0, 6000.0), (10.0, 100.0))
    geared = Accelerate(SMART, engine, Transmission("gears", RATIOS), 10.0, 100.0 / 3.6)
    charged = replace(geared, transmission=Transmission("gears", RATIOS, shift_cost_j=3000.0))
    variable = replace(geared, transmission=Transmission("cvt"))
    figures = []
    for name, problem in {"six gears": geared, "gears with charged shifts": charged, "a CVT": variable}.items():
        hurried = replace(problem, time_s=HURRIED * solve(problem).time_s)
        plain_ms = 1e3 * timed(lambda p=problem: least_lagrangian(p, drive_numbers(p), 0.0))  # type: ignore[misc]
        for kind, one, goal in (("free", problem, "at most 1 ms"), ("exact", hurried, "at most 5 ms")):
            ours_ms = 1e3 * best_seconds(lambda p=one: solve(p), REPEATS)  # type: ignore[misc]
            what = f"36 to 100 km/h in {kind} time, {name}"
            figures.append(Figure(what, ours_ms, "ms", plain_ms, "free time on grids in NumPy", goal=goal))
    idling = replace(engine, idle_fuel_power_w=IDLE_W)
    return figures + routes(SMART, idling, RATIOS)
