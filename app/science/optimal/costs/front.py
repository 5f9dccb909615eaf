"""Pareto fronts: fuel against an emission by weights, fuel against time by the time that is given."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import hypot
from typing import Any

from app.science.optimal.answer import Answer
from app.science.optimal.costs.frontier import Front, FrontError, FrontPoint
from app.science.optimal.costs.least_time import least_time_s
from app.science.optimal.costs.recounting import misfits
from app.science.optimal.costs.weighted import CO2, FUEL, TIME, Cost, WeightedDrive, WeightedEngine, weighted
from app.science.optimal.problem import Accelerate, BallAndWheel, DriveProblem, Engine, Route
from app.science.optimal.reading import MapResolver, no_maps, read_problem
from app.science.optimal.solve import solve
from app.science.progress import Progress, between, silent

WHOLE = "weighted"
LEAST_POINTS, MOST_POINTS = 2, 100
OF_THE_OTHER = 1e-3
"""Weight of the first axis at the end of the second, so that nothing is wasted where it costs nothing."""
PER_GRAM_J = 1e5
"""Weight of the first axis where it is no fuel, so that costs are as large as the energies that solvers know."""
ON_THE_CHORD = 1e-6
ABOVE_FASTEST = 1e-3


@dataclass(frozen=True, slots=True)
class Supported:
    """A drive and the line in the plane of both axes that no drive goes below: ``weight_x x + weight_y y``."""

    point: FrontPoint
    x: float
    y: float
    weight_x: float
    weight_y: float


Between = Callable[[Supported, Supported, Progress], Supported | None]


def pareto(
    document: object,
    emission: str,
    points: int = 9,
    progress: Progress = silent,
    *,
    against: str = FUEL,
    resolve_map: MapResolver = no_maps,
) -> Front:
    """Return the front of fuel against an emission or against time.

    The two ends come first; then the part where the front may still bend most is halved. Of the weights that a problem
    has of its own, those of the two axes are swept and the others left out. A front against time has all of them.

    Parameters
    ----------
    document : object
        A problem document.
    emission : str
        An emission with a map in ``cost.emissions``, ``co2``, or ``time``.
    points : int
        2 to 100; fewer where no more are found.
    progress : callable
    against : str
        The first axis: ``fuel``, or another emission.
    resolve_map : callable
        As for `read_problem`.

    Raises
    ------
    FrontError
        When there is no such front.
    ProblemError, Infeasible
        As for a single drive.
    """
    if not LEAST_POINTS <= points <= MOST_POINTS:
        raise FrontError(f"A front has {LEAST_POINTS} to {MOST_POINTS} points; {points} are asked for.")
    problem = read_problem(document, resolve_map)
    if isinstance(problem, BallAndWheel):
        raise FrontError("A ball on a wheel burns nothing, so there is no front.")
    if emission == TIME:
        return _against_time(problem, against, points, progress)
    return _of_two(problem, against, emission, points, progress)


def _of_two(problem: DriveProblem, one: str, other: str, points: int, progress: Progress) -> Front:
    """Sweep the weights of two axes."""
    engine, cost = _parts(problem.engine)
    known = (FUEL, CO2, *(found.name for found in cost.emissions))
    for name in (one, other):
        if name not in known:
            raise FrontError(
                f"There is no map of {name} among cost.emissions; this problem knows {', '.join(known)} and time."
            )
    if {one, other} <= {FUEL, CO2} or one == other:
        raise FrontError(
            f"{one} and {other} grow with each other, so the best drive is the same for both; ask for an emission that "
            "has a map, or for time."
        )

    unit = 1.0 if one == FUEL else PER_GRAM_J

    def at(weight_x: float, weight_y: float, tell: Progress) -> Supported:
        shares = replace(cost, weights=((one, unit * weight_x), (other, unit * weight_y)))
        answer = _answer(replace(problem, engine=weighted(engine, shares)), tell)
        x, y = (_formula(answer, name) for name in (one, other))
        return Supported(_point(answer, one, other), x, y, weight_x, weight_y)

    def halved(left: Supported, right: Supported, tell: Progress) -> Supported | None:
        fall, rise = left.y - right.y, right.x - left.x
        if fall <= 0.0 or rise <= 0.0:
            return None
        found = at(1.0, rise / fall, tell)
        chord = left.x + rise / fall * left.y
        below = chord - found.x - rise / fall * found.y
        return found if below > ON_THE_CHORD * chord else None

    first = at(1.0, 0.0, between(progress, 0.0, 1.0 / points))
    if first.y <= 0.0:
        return _front(one, other, [first], [], (f"The best drive has no {other} at all; there is nothing to trade.",))
    level = first.x / first.y
    last = at(OF_THE_OTHER, level, between(progress, 1.0 / points, 2.0 / points))
    found, edges = _swept(first, last, halved, points, progress)
    said = tuple(
        f"Between points {k + 1} and {k + 2} no weights lead to another drive: the front is straight there, or bends "
        "inward, where weights can't reach it."
        for k in edges
    )
    return _front(one, other, found, edges, (*misfits(cost), *said))


def _against_time(problem: DriveProblem, against: str, points: int, progress: Progress) -> Front:
    """Give the drive less and less time, from the best one's own down to the least."""
    if against != FUEL:
        raise FrontError(f"A front against time is one of fuel; {against} can be weighed in the problem's own cost.")
    if not isinstance(problem, Accelerate | Route):
        raise FrontError("A distance is driven in free time; pose a route for a front against time.")

    whole = WHOLE if isinstance(problem.engine, WeightedEngine | WeightedDrive) else FUEL

    def at(seconds: float | None, tell: Progress) -> Supported:
        timed = (
            replace(problem, time_s=seconds)
            if isinstance(problem, Accelerate)
            else replace(problem, max_time_s=seconds)
        )
        answer = _answer(timed, tell)
        point = _point(answer, whole, TIME)
        return Supported(point, point.x, point.y, 1.0, max(answer.multiplier_w, 0.0))

    def halved(left: Supported, right: Supported, tell: Progress) -> Supported | None:
        if left.y - right.y <= ON_THE_CHORD * left.y:
            return None
        return at(0.5 * (left.y + right.y), tell)

    first = at(None, between(progress, 0.0, 1.0 / points))
    fastest = min(least_time_s(problem) * (1.0 + ABOVE_FASTEST), first.y)
    last = at(fastest, between(progress, 1.0 / points, 2.0 / points))
    found, _ = _swept(first, last, halved, points, progress)
    return _front(whole, TIME, found, [], ())


def _swept(
    first: Supported, last: Supported, halved: Between, points: int, progress: Progress
) -> tuple[list[Supported], list[int]]:
    """Halve where the front may still bend most; also returns after which points nothing more was found."""
    found = [first, last]
    closed: set[tuple[int, int]] = set()
    while len(found) < points:
        progress(len(found) / points)
        pairs = [k for k in range(len(found) - 1) if (id(found[k]), id(found[k + 1])) not in closed]
        if not pairs:
            break
        k = max(pairs, key=lambda at: _unknown(found[at], found[at + 1], first, last))
        done = len(found) / points
        new = halved(found[k], found[k + 1], between(progress, done, done + 1.0 / points))
        if new is None:
            closed.add((id(found[k]), id(found[k + 1])))
        else:
            found.insert(k + 1, new)
    progress(1.0)
    found = undominated(found)
    return found, [k for k in range(len(found) - 1) if (id(found[k]), id(found[k + 1])) in closed]


def undominated(found: list[Supported]) -> list[Supported]:
    """Leave drives out that another one beats in both: those of solvers that find no certain optimum may be."""
    return [
        one
        for one in found
        if not any(other.x <= one.x and other.y <= one.y and (other.x < one.x or other.y < one.y) for other in found)
    ]


def _unknown(left: Supported, right: Supported, first: Supported, last: Supported) -> float:
    """Return how long the part between two drives is, and how far the front may lie below it, of its whole extent."""
    wide, high = (abs(last.x - first.x) or 1.0), (abs(first.y - last.y) or 1.0)
    rise, fall = (right.x - left.x) / wide, (left.y - right.y) / high
    chord = hypot(rise, fall)
    (a, b), (c, d) = ((one.weight_x * wide, one.weight_y * high) for one in (left, right))
    cross = a * d - b * c
    if cross <= 0.0 or chord == 0.0:
        return 0.1 * chord
    # the corner where the two lines meet that no drive goes below, seen from the left drive
    reach = c * rise - d * fall
    corner_x, corner_y = -b * reach / cross, a * reach / cross
    return abs(corner_x * fall + corner_y * rise) / chord + 0.1 * chord


def _answer(problem: DriveProblem, progress: Progress) -> Answer:
    found = solve(problem, progress)
    if not isinstance(found, Answer):
        raise FrontError("The problem has no drive as its answer.")
    return found


def _parts(engine: Engine) -> tuple[Engine, Cost]:
    """Return the engine as posed, and what a drive may cost."""
    if isinstance(engine, WeightedEngine | WeightedDrive):
        return engine.fuel, engine.cost
    return engine, Cost(((FUEL, 1.0),), 0.0)


def _formula(answer: Answer, name: str) -> float:
    """Return fuel, CO2 or an emission as the solver counts it."""
    if name == FUEL:
        return answer.fuel_energy_j
    if name == CO2:
        return float(answer.more["emissions_g"][CO2])
    return float(answer.more["cost"]["emissions"][name]["by_formula_g"])


def _point(answer: Answer, one: str, other: str) -> FrontPoint:
    emissions = dict(answer.more.get("emissions_g", {}))
    cost: Any = answer.more.get("cost", {"weights": {}, "weighted_energy_j": answer.fuel_energy_j})
    whole = cost["weighted_energy_j"]
    values = {FUEL: answer.fuel_energy_j, WHOLE: whole, TIME: answer.time_s, **emissions}
    unit = cost["weights"].get(one) or 1.0
    independent = answer.certificate.independent
    return FrontPoint(
        x=values[one],
        y=values[other],
        weights={name: weight / unit for name, weight in cost["weights"].items()},
        fuel_energy_j=answer.fuel_energy_j,
        time_s=answer.time_s,
        distance_m=answer.distance_m,
        emissions_g=emissions,
        gears=answer.gears,
        verdict=answer.certificate.verdict,
        relative_gap=independent.relative_gap if independent else None,
    )


def _front(one: str, other: str, found: list[Supported], edges: Iterable[int], warnings: tuple[str, ...]) -> Front:
    names = {FUEL: "fuel_energy_j", WHOLE: "weighted_energy_j", TIME: "time_s"}
    return Front(
        names.get(one, f"{one}_g"),
        names.get(other, f"{other}_g"),
        tuple(one.point for one in found),
        tuple((k, k + 1) for k in edges),
        warnings,
    )
