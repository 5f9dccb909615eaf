"""The least fuel to reach a speed on the level, in free or in given time (Sebesta 2010, 4.4).

The thesis shoots for the costate; here the cheapest control at each speed is found by itself and integrated over speed,
and a given time is a root in the price of time, so nothing depends on a guess.
"""

from __future__ import annotations

from dataclasses import dataclass

from app.science.optimal.accelerate.exact_time import Makes, Priced, Request, on_time
from app.science.optimal.accelerate.kernels import GEARS, DriveNumbers
from app.science.optimal.accelerate.lingering import Linger
from app.science.optimal.accelerate.numbers import drive_numbers, speed_range_mps
from app.science.optimal.accelerate.plan import Plan, plan
from app.science.optimal.accelerate.unhurried import unhurried
from app.science.optimal.problem import Accelerate, Infeasible, WillansDrive

DEAREST_W = 1e12
AS_FAST = 1e-9
LEAST_HURRY = 1e-6


@dataclass(frozen=True, slots=True)
class Solution:
    """An extremal of the problem.

    Attributes
    ----------
    slowing : Plan
        First down from the starting speed, where lingering at a lower speed is cheaper; usually without phases.
    linger : Linger or None
        Where the rest of the time is spent.
    rising : Plan
        Up to the speed that is wanted; in two parts around a place to linger between.
    before : Plan
        The part of the rise before lingering.
    mu_w : float
        Price of a second.
    bound_j : float
        No drive takes less fuel and charges, as far as this way of solving knows.
    """

    slowing: Plan
    before: Plan
    linger: Linger | None
    rising: Plan
    mu_w: float
    bound_j: float

    @property
    def fuel_j(self) -> float:
        """Fuel energy, J."""
        lingered = self.linger.fuel_j if self.linger else 0.0
        return self.slowing.fuel_j + self.before.fuel_j + lingered + self.rising.fuel_j

    @property
    def time_s(self) -> float:
        """Time, s."""
        lingered = self.linger.seconds if self.linger else 0.0
        return self.slowing.time_s + self.before.time_s + lingered + self.rising.time_s


NOTHING = Plan(())


def solve(problem: Accelerate) -> Solution:
    """Solve the problem.

    Raises
    ------
    Infeasible
        When the speeds can't be reached, or not in the time that is given.
    """
    drive = drive_numbers(problem)
    check_speeds(problem, drive)
    start, end, charge = problem.from_speed_mps, problem.to_speed_mps, problem.transmission.shift_cost_j
    free = plan(drive, start, end, 0.0, shift_cost_j=charge)
    if free is None:
        raise out_of_reach(problem, drive)
    request = Request(drive, start, end, problem.time_s or free.time_s, charge)
    if problem.time_s is None:
        return Solution(NOTHING, NOTHING, None, free, 0.0, request.charged(free))
    if problem.time_s <= free.time_s:
        found = hurried(request, free)
        return Solution(NOTHING, NOTHING, None, found.way, found.mu_w, found.bound_j)
    return Solution(*unhurried(request))


def hurried(request: Request, free: Plan) -> Priced:
    """Pay for time until the drive is as short as wanted."""
    make = Makes(lambda mu: free if mu == 0.0 else request.at(mu))
    cheap, dear = 0.0, free.fuel_j / free.time_s * max(free.time_s / request.time_s - 1.0, LEAST_HURRY)
    while dear < DEAREST_W:
        way = make(dear)
        if way is not None and way.time_s <= request.time_s:
            return on_time(request, cheap, dear, make)
        cheap, dear = dear, 4.0 * dear
    fastest = plan(request.drive, request.slow_mps, request.fast_mps, 1.0, weight=0.0)
    if fastest is not None and fastest.time_s <= request.time_s * (1.0 + AS_FAST):
        return Priced(fastest, dear, request.charged(fastest))
    least = float("inf") if fastest is None else fastest.time_s
    raise Infeasible(
        f"{request.time_s:g} s are too short by {least - request.time_s:.4g} s: at full load in the best gears it "
        f"takes {least:.5g} s.",
        "time_s",
    )


def check_speeds(problem: Accelerate, drive: DriveNumbers) -> None:
    """Refuse speeds at which no gear can be engaged."""
    slowest, fastest = speed_range_mps(drive)
    start, end = problem.from_speed_mps, problem.to_speed_mps
    if start < slowest * (1.0 - 1e-12):
        raise Infeasible(
            f"{start:g} m/s is {slowest - start:.3g} m/s below the lowest speed of first gear, {slowest:.4g} m/s at "
            f"the engine's lowest speed.",
            "from_speed_mps",
        )
    if end > fastest * (1.0 + 1e-12):
        raise Infeasible(
            f"the ratios never reach {end:g} m/s: the last gear ends at {fastest:.4g} m/s, {end - fastest:.3g} m/s "
            "short, at the engine's highest speed.",
            "transmission.ratios",
        )


def out_of_reach(problem: Accelerate, drive: DriveNumbers) -> Infeasible:
    """Return why no drive leads up to the speed: the highest speed that is reached, and what binds there."""
    low, high = problem.from_speed_mps, problem.to_speed_mps
    for _ in range(50):
        middle = 0.5 * (low + high)
        if plan(drive, problem.from_speed_mps, middle, 0.0) is None:
            high = middle
        else:
            low = middle
    lost = problem.to_speed_mps - low
    limit = "engine.power_w" if isinstance(problem.engine, WillansDrive) else "engine.torque_nm"
    at_end = drive.kind == GEARS and any(
        abs(drive.engine.highest_radps / n - low) < 1e-6 * low for n in drive.spd_1pm
    )  # a gear ends here
    why = "no gear pulls beyond the engine's highest speed" if at_end else "full load only just holds it"
    return Infeasible(
        f"{problem.to_speed_mps:g} m/s can't be reached: from {problem.from_speed_mps:g} m/s the car gets to "
        f"{low:.4g} m/s, {lost:.3g} m/s short; there {why}.",
        f"to_speed_mps, {limit}",
    )
