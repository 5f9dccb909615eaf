"""A trip's accelerations beside those that Pontryagin's principle gives (Sebesta 2010, Table 4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.best import Car, ride_of_trajectory
from app.science.eco.losses import Drive, in_cells, joule_price
from app.science.eco.result import Acceleration, TableRow
from app.science.eco.ride import burnt
from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.accelerate.solve import solve
from app.science.optimal.accelerate.trace import traced
from app.science.optimal.fuel_checks import full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, Accelerate, Infeasible, Transmission

LEAST_RISE_MPS = 5.0
DIP_MPS = 0.5
BRISK_MPS2 = 0.3
JUST_ABOVE = 1.0001
HARD, SOFT = 0.75, 0.4
"""Shares of full load, on average, above and below which an acceleration is called hard and soft."""


def rises(t_s: FloatArray, speed_mps: FloatArray, slowest: float) -> list[tuple[int, int]]:
    """Return the first and last index of the brisk part of each rise of the speed.

    A dip of half a metre per second doesn't end a rise. Drifting up over a minute is no acceleration: beside a drive
    without a distance to keep it would only tell of the road that it covers meanwhile.

    Parameters
    ----------
    t_s, speed_mps : array, shape (n,)
    slowest : float
        Below it nothing is compared, m/s.
    """
    found: list[tuple[int, int]] = []
    low = high = 0
    for k, v in enumerate(speed_mps.tolist()):
        if v < slowest:
            found += _brisk(t_s, speed_mps, low, high)
            low = high = k + 1
        elif high < low or v > speed_mps[high]:
            high = k
        elif v < speed_mps[high] - DIP_MPS or v < speed_mps[low]:
            found += _brisk(t_s, speed_mps, low, high)
            low = high = k
    return found + _brisk(t_s, speed_mps, low, high)


def _brisk(t_s: FloatArray, speed_mps: FloatArray, low: int, high: int) -> list[tuple[int, int]]:
    """Return the part of a rise that gains most on a steady rise by `BRISK_MPS2`, where it is large enough.

    So its mean acceleration is at least that, and so is that of its beginning and of its end.
    """
    if high <= low:
        return []
    ahead = speed_mps[low : high + 1] - BRISK_MPS2 * t_s[low : high + 1]
    last = int(np.argmax(ahead - np.minimum.accumulate(ahead)))
    first = last - int(np.argmin(ahead[: last + 1][::-1]))
    rise = speed_mps[low + last] - speed_mps[low + first]
    return [(low + first, low + last)] if rise >= LEAST_RISE_MPS else []


def acceleration(driven: Drive, car: Car) -> Acceleration:
    """Compare one rise with the best drives on the level, in any time and in the driven time.

    What the road's rise took is taken out of the driven energy at the price of a joule of work.

    Parameters
    ----------
    driven : Drive
        From its lowest to its highest speed.
    car : Car
    """
    ride = driven.ride
    half = 0.5 * ride.accel_mps2 * ride.dt_s
    start, end = float(ride.speed_mps[0] - half[0]), float(ride.speed_mps[-1] + half[-1])
    rise_m = float((ride.sin_slope * ride.speed_mps) @ ride.dt_s)
    climbing_j = car.load.mass_kg * car.load.gravity_mps2 * rise_m
    said = Acceleration(
        from_s=float(ride.t_s[0]),
        to_s=float(ride.t_s[-1] + ride.dt_s[-1]),
        from_mps=start,
        to_mps=end,
        time_s=driven.time_s,
        distance_m=float(ride.speed_mps @ ride.dt_s),
        rise_m=rise_m,
        style=_style(driven, car),
        shift_rpm=shifts_up_rpm(driven),
        driven_j=driven.fuel_j - joule_price((driven,)) * climbing_j,
    )
    problem = Accelerate(car.load, car.engine, Transmission("gears", car.ratios), start, end)
    try:
        free = _best(problem, car)
        timed = _best(replace(problem, time_s=driven.time_s), car)
    except Infeasible as error:
        return replace(said, reason=str(error))
    return replace(
        said,
        free_j=free.fuel_j,
        free_s=free.time_s,
        free_m=float(free.ride.speed_mps @ free.ride.dt_s),
        same_time_j=timed.fuel_j,
        best_shift_rpm=shifts_up_rpm(free),
        free_percent=100.0 * (free.fuel_j / said.driven_j - 1.0),
        same_time_percent=100.0 * (timed.fuel_j / said.driven_j - 1.0),
    )


def table_4_2(rows: Sequence[Acceleration]) -> tuple[TableRow, ...]:
    """Add the accelerations that have something to compare with up to one table."""
    known = [row for row in rows if row.free_j is not None and row.same_time_j is not None]
    driven = sum(row.driven_j for row in known)
    if driven <= 0.0:
        return ()
    free = sum(row.free_j or 0.0 for row in known)
    timed = sum(row.same_time_j or 0.0 for row in known)
    return (
        TableRow("As driven", driven / 1000.0, None),
        TableRow("Pontryagin, in any time", free / 1000.0, 100.0 * (free / driven - 1.0)),
        TableRow("Pontryagin, in the driven time", timed / 1000.0, 100.0 * (timed / driven - 1.0)),
    )


def shifts_up_rpm(drive: Drive) -> tuple[float, ...]:
    """Return the engine speeds at which a drive leaves a gear for a higher one, rpm."""
    rows = np.flatnonzero(drive.ride.gear > 0)
    gear, rpm = drive.ride.gear[rows], drive.ride.engine_radps[rows] / RADPS_PER_RPM
    return tuple(rpm[:-1][gear[1:] > gear[:-1]].tolist())


def _best(problem: Accelerate, car: Car) -> Drive:
    """Return the best drive on the level, charged as the driven one is."""
    found = traced(solve(problem), drive_numbers(problem)).trajectory
    ride = ride_of_trajectory(found, car)
    return Drive(ride, burnt(ride, car.load, car.model))


def _style(driven: Drive, car: Car) -> str:
    """Say in a few words how hard it was."""
    pulling = in_cells(driven)
    if not pulling.any():
        return "rolling"
    rpm = driven.ride.engine_radps[pulling] / RADPS_PER_RPM
    share = float((driven.took.torque_nm[pulling] / full_load_nm(car.engine, rpm)).mean())
    word = "hard" if share > HARD else "soft" if share < SOFT else "moderate"
    return f"{word}, {100.0 * share:.0f} % of full load"
