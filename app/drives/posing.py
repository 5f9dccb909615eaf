"""From a problem document to a drive: read at once, so that what is wrong is told before anybody waits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from app.drives.engines import MapEngine, engine_of_car
from app.drives.schemas import MOST_ROAD_POINTS
from app.science.fields import Fields, ProblemError
from app.science.optimal.fuel_checks import concavity
from app.science.optimal.problem import PolynomialEngine, Problem, WillansDrive
from app.science.optimal.reading import read_problem
from app.storage.blobs import Blobs
from app.storage.keys import stage_key

WORTH_SAYING = 0.01
KMH_PER_MPS = 3.6
MINUTE_S, LONG_S = 60.0, 100.0


@dataclass(frozen=True, slots=True)
class PosedDrive:
    """A document that can be solved.

    Attributes
    ----------
    kind : str
    engine : mapping or None
        What an engine that names a map became.
    map_of : MapEngine or None
    sha256 : str
        Of the problem with that engine.
    warnings : tuple of str
        What is worth knowing beforehand.
    """

    kind: str
    engine: Mapping[str, Any] | None
    map_of: MapEngine | None
    sha256: str
    warnings: tuple[str, ...]


def read_posed(session: Session, blobs: Blobs, document: Mapping[str, Any], car_id: str | None) -> PosedDrive:
    """Read a problem document; raises `ProblemError` with the path of what is wrong."""
    _check_size(document)
    found: list[MapEngine] = []

    def look_up(engine: Fields) -> Mapping[str, Any]:
        found.append(engine_of_car(session, blobs, engine, car_id))
        return found[0].engine

    problem = read_problem(document, look_up)
    of_map = found[0] if found else None
    engine = None if of_map is None else of_map.engine
    key = stage_key("problem", problem=resolved(document, engine))
    return PosedDrive(str(document["kind"]), engine, of_map, key, _warnings(problem))


def _warnings(problem: Problem) -> tuple[str, ...]:
    engine = getattr(problem, "engine", None)
    found = concavity(engine) if isinstance(engine, PolynomialEngine | WillansDrive) else None
    if found is None or found.share < WORTH_SAYING:
        return ()
    share = f"{100.0 * found.share:.0f} %"
    return (f"Fuel power is concave in {share} of what the engine can do: the best drive may pulse there.",)


def resolved(problem: Mapping[str, Any], engine: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return a problem with an engine that says what it burns, as `./ponthy drive` takes it."""
    return dict(problem) if engine is None else dict(problem) | {"engine": dict(engine)}


def _check_size(document: Mapping[str, Any]) -> None:
    road = document.get("road")
    for name, values in road.items() if isinstance(road, Mapping) else ():
        if isinstance(values, list) and len(values) > MOST_ROAD_POINTS:
            message = (
                f"has {len(values)} points; {MOST_ROAD_POINTS} at most. Leave out points where the slope is steady."
            )
            raise ProblemError(f"road.{name}", message)


def title_of(problem: Mapping[str, Any]) -> str:
    """Return what a drive does in a few words, for one that was given no name."""
    match problem["kind"]:
        case "accelerate":
            begin, end = (KMH_PER_MPS * problem[name] for name in ("from_speed_mps", "to_speed_mps"))
            time_s = problem.get("time_s")
            return f"{begin:.0f} to {end:.0f} km/h" + ("" if time_s is None else f" in {_lasting(time_s)}")
        case "distance":
            return f"{_long(problem['distance_m'])} on the level"
        case "route":
            at = problem["road"]["distance_m"]
            longest = problem.get("max_time_s")
            return f"{_long(at[-1] - at[0])} of road" + ("" if longest is None else f" in {_lasting(longest)}")
        case _:
            return "Ball on a wheel"


def _long(distance_m: float) -> str:
    return f"{distance_m:.0f} m" if distance_m < 1000.0 else f"{distance_m / 1000.0:.1f} km"


def _lasting(time_s: float) -> str:
    return f"{time_s:.4g} s" if time_s < LONG_S else f"{time_s // MINUTE_S:.0f}:{time_s % MINUTE_S:02.0f} min"
