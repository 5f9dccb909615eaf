"""Why no drive fulfils a route: which number is impossible, where, and by how much."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.problem import Infeasible, Route, WillansDrive
from app.science.optimal.route.car import is_geared, speed_range_mps
from app.science.optimal.route.stage_kernels import Car, Column, band_n
from app.science.optimal.route.stages import Stages

LEAST_LIMIT_MPS = 0.1
SLACK = 1e-9
LONGEST_GAP_M = 5000.0


def check_words(problem: Route) -> None:
    """Refuse speeds that contradict each other before anything is driven."""
    road, low = problem.road, problem.min_speed_mps
    for k, limit in enumerate(road.speed_limit_mps[:-1]):
        if limit < max(low, LEAST_LIMIT_MPS):
            place = f"{road.distance_m[k]:g} m"
            if low <= LEAST_LIMIT_MPS:
                raise Infeasible(
                    f"the limit from {place} on is {limit:g} m/s; at least {LEAST_LIMIT_MPS:g} m/s are needed to "
                    "get on. A stop ends a route: pose the road in parts.",
                    f"road.speed_limit_mps[{k}]",
                )
            raise Infeasible(
                f"the limit from {place} on, {limit:g} m/s, is {low - limit:.4g} m/s below min_speed_mps, {low:g} m/s.",
                f"road.speed_limit_mps[{k}], min_speed_mps",
            )
    at = np.array(road.distance_m)
    gaps = np.diff(at)
    if (gaps > LONGEST_GAP_M).any() and (np.abs(np.diff(road.elevation_m))[gaps > LONGEST_GAP_M] > 0.0).any():
        k = int(np.flatnonzero((gaps > LONGEST_GAP_M) & (np.abs(np.diff(road.elevation_m)) > 0.0))[0])
        raise Infeasible(
            f"the road has a gap of {gaps[k]:g} m after {at[k]:g} m, across which its elevation changes by "
            f"{road.elevation_m[k + 1] - road.elevation_m[k]:.4g} m; no slope is known there. Points may stand at most "
            f"{LONGEST_GAP_M:g} m apart on a hill.",
            f"road.distance_m[{k + 1}]",
        )
    ends = (
        ("from_speed_mps", problem.from_speed_mps, road.speed_limit_mps[0], "at the road's start"),
        ("to_speed_mps", problem.to_speed_mps, road.speed_limit_mps[-2], "at the road's end"),
    )
    for name, speed, limit, where in ends:
        if speed > limit:
            raise Infeasible(
                f"{speed:g} m/s is {speed - limit:.4g} m/s above the limit of {limit:g} m/s {where}.",
                f"{name}, road.speed_limit_mps",
            )
        if speed < low:
            raise Infeasible(
                f"{speed:g} m/s is {low - speed:.4g} m/s below min_speed_mps, {low:g} m/s.", f"{name}, min_speed_mps"
            )


def out_of_reach(problem: Route, stages: Stages, ahead: FloatArray, floor_mps: FloatArray, car: Car) -> Infeasible:
    """Return why the speeds that the start leads to end somewhere: too fast there, too slow, or no gear engaged."""
    k = int(np.flatnonzero(~np.isfinite(ahead[:, 0]))[0])
    place, reached, cap = stages.edges_m[k], float(ahead[k, 1]), float(stages.cap_mps[k])
    if k == len(ahead) - 1 and not reached > cap:
        end = problem.to_speed_mps
        if reached > end:
            return Infeasible(
                f"the car can't slow down to {end:g} m/s by the road's end: it arrives with {reached:.4g} m/s, "
                f"{reached - end:.3g} m/s too fast{_brakes(problem)}.",
                "to_speed_mps, brake_max_n",
            )
        if reached == reached:
            return Infeasible(
                f"{end:g} m/s can't be reached by the road's end: the car gets to {reached:.4g} m/s, "
                f"{end - reached:.3g} m/s short.",
                f"to_speed_mps, {_strength(problem)}",
            )
    if reached > cap:
        return Infeasible(
            f"at {place:g} m the limit is {cap:g} m/s, and the car can't be slower than {reached:.4g} m/s there, "
            f"{reached - cap:.3g} m/s too fast{_brakes(problem)}.",
            f"brake_max_n, road.speed_limit_mps[{_point(problem, place)}]",
        )
    low, high = ahead[k - 1]
    slowest, fastest = speed_range_mps(car)
    if is_geared(car) and high < slowest * (1.0 - SLACK):
        return Infeasible(
            f"at {stages.edges_m[k - 1]:g} m the car does {high:.4g} m/s, {slowest - high:.3g} m/s below the lowest "
            f"speed of first gear, {slowest:.4g} m/s at the engine's lowest speed; no gear can be engaged"
            f"{'' if problem.transmission.neutral else ', and there is no neutral'}.",
            "from_speed_mps" if k == 1 else "engine.speed_rpm",
        )
    if is_geared(car) and low > fastest * (1.0 + SLACK):
        return Infeasible(
            f"at {stages.edges_m[k - 1]:g} m the car does {low:.4g} m/s, and the last gear ends at {fastest:.4g} m/s.",
            "transmission.ratios",
        )
    hold = float(floor_mps[k])
    strongest = max((pull for _, pull in _bands(max(high, hold), car)), default=0.0)
    need = float(stages.grade_n[k - 1]) + problem.load.drag_kgpm * max(high, hold) ** 2
    if need <= strongest:
        return not_connected(stages, k - 1)
    return Infeasible(
        f"the road is too steep before {place:g} m: holding {max(high, hold):.4g} m/s takes {need:.4g} N at the "
        f"wheels, {need - strongest:.4g} N more than the engine gives there, and the car falls below {hold:g} m/s.",
        f"{_strength(problem)}, road.elevation_m[{_point(problem, place)}]",
    )


def not_connected(stages: Stages, k: int) -> Infeasible:
    """Return that no speed at an edge leads on to the end."""
    return Infeasible(
        f"no speed at {stages.edges_m[k]:g} m leads on to the end: gears, neutral and brakes leave none from which the "
        "car can go on.",
        "transmission",
    )


def check_standstill(problem: Route, least_w: float) -> None:
    """Refuse to stand still with a drive that can't give less than some power."""
    for name, speed in (("from_speed_mps", problem.from_speed_mps), ("to_speed_mps", problem.to_speed_mps)):
        if speed == 0.0 and least_w > 0.0 and not (name == "to_speed_mps" and problem.transmission.neutral):
            raise Infeasible(
                f"the drive gives {least_w:.4g} W at least, which would be a force without bounds at standstill; begin "
                "and end at a speed above 0, or let its lowest torque or power be 0.",
                f"{name}, {_strength(problem).replace('torque_nm', 'torque_nm[0]').replace('power_w', 'power_w[0]')}",
            )


def too_short(problem: Route, fastest_s: float) -> Infeasible:
    """Return by how much the time is too short."""
    longest = problem.max_time_s or 0.0
    return Infeasible(
        f"{longest:g} s are too short by {fastest_s - longest:.4g} s: as fast as limits, gears and brakes allow it "
        f"takes {fastest_s:.6g} s.",
        "max_time_s",
    )


def no_drive(problem: Route) -> Infeasible:
    """Return that the search found nothing between bounds that can each be reached."""
    if problem.max_time_s is None:
        why, limit = "the gears leave gaps between them", "transmission"
    else:
        why, limit = f"{problem.max_time_s:g} s are too close to the least time for one to be found", "max_time_s"
    return Infeasible(
        f"every speed along the road can be reached, but no drive was found from its start to its end; {why}.",
        limit,
    )


def _bands(speed_mps: float, car: Car) -> Iterator[tuple[float, float]]:
    for row in car.columns:
        low, high = band_n(Column(*row), car.engine.full_load_radps, car.engine.full_load_nm, speed_mps)
        if low <= high:
            yield low, high


def _point(problem: Route, place_m: float) -> int:
    return int(np.searchsorted(problem.road.distance_m, place_m - 1e-6 * max(abs(place_m), 1.0)))


def _strength(problem: Route) -> str:
    return "engine.power_w" if isinstance(problem.engine, WillansDrive) else "engine.torque_nm"


def _brakes(problem: Route) -> str:
    if problem.brake_max_n <= 0.0:
        return "; it has no brakes (brake_max_n is 0)"
    if (
        problem.transmission.kind == "gears"
        and not isinstance(problem.engine, WillansDrive)
        and not problem.transmission.neutral
    ):
        return "; brakes act in neutral only, and there is none"
    return f" with brakes of {problem.brake_max_n:g} N"
