"""What can be compared: a version of a car's map, or the trips of a period, of this car or another one."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime, timedelta

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import Invalid, NotFound
from app.maps import repository
from app.maps.documents import efficiency_map
from app.maps.models import MapVersion
from app.maps.packing import unpack_sums
from app.maps.rules import rules_of
from app.science.engine.cells import build_map, merge
from app.science.engine.efficiency_map import CellGrid, CellSums, EfficiencyMap
from app.science.engine.moments import COLUMN_RPM, KEPT_ROWS, LONGEST_S, STEP
from app.science.engine.resolution import resolve
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.trips import service as trips

GRID = CellGrid()
DAY = r"\d{4}-\d\d-\d\d"
CHOICE = re.compile(
    rf"(?:(?P<car>[0-9a-f]{{32}}):)?(?:(?P<version>latest|[0-9]{{1,9}})|(?P<since>{DAY})?\.\.(?P<until>{DAY})?)"
)


@dataclass(frozen=True, slots=True)
class Side:
    """One of two maps that are compared.

    Attributes
    ----------
    car_id, car_name : str
    title : str
        Which map of the car.
    version : MapVersion or None
        None for a period.
    trips : mapping of str to str
        Observer run of each trip it was made from.
    sums : mapping of str to CellSums or None
        The cells of each of these runs; None where one of them is no longer kept.
    """

    car_id: str
    car_name: str
    title: str
    version: MapVersion | None
    trips: Mapping[str, str]
    sums: Mapping[str, CellSums] | None


def cells_key(observe_key: str) -> str:
    """Return the name of the cells of an observer run."""
    return stage_key("cells", observed=observe_key, grid=asdict(GRID), moments=[COLUMN_RPM, STEP, KEPT_ROWS, LONGEST_S])


def read_side(session: Session, car_id: str, choice: str, name: str) -> Side:
    """Return what a choice means: ``3``, ``latest``, ``2026-03-01..2026-06-30``, each perhaps after ``CAR_ID:``.

    Either end of a period may be left open; both days count.

    Raises
    ------
    Invalid
        When the choice can't be read; ``name`` says which one it is.
    NotFound
        When there is no such car or version.
    """
    found = CHOICE.fullmatch(choice)
    if found is None:
        message = (
            f"{choice!r} is no map to compare: it is a version such as 3 or latest, or a period such as "
            "2026-03-01..2026-06-30; another car's stands after its identifier and a colon."
        )
        raise Invalid("bad-map-choice", message, field=f"query.{name}")
    owner = found["car"] or car_id
    car = cars.get(session, owner)
    if found["version"] is None:
        begin, end = _day(found["since"], name), _day(found["until"], name)
        return _of_period(session, owner, car.name, begin, end)
    number = None if found["version"] == "latest" else int(found["version"])
    version = repository.version(session, owner, number)
    if version is None:
        raise NotFound("map version", found["version"])
    return _of_version(session, owner, car.name, version)


def map_of(session: Session, blobs: Blobs, side: Side) -> EfficiencyMap:
    """Return the map of a side."""
    if side.version is not None:
        return efficiency_map(blobs, side.version)
    resolved = resolve(merge((side.sums or {}).values()), GRID)
    return build_map(resolved.sums, resolved.grid, cars.config(session, side.car_id).vehicle)


def _of_version(session: Session, car_id: str, car_name: str, version: MapVersion) -> Side:
    made_from = {trip["trip_id"]: trip["observe_key"] for trip in version.provenance["trips"]}
    sums = kept_sums(session, version, {})
    return Side(car_id, car_name, f"version {version.version}", version, made_from, sums)


def _of_period(session: Session, car_id: str, car_name: str, since: datetime | None, until: datetime | None) -> Side:
    end = None if until is None else until + timedelta(days=1)
    period = replace(rules_of(session, car_id), since=since, until=end)
    there = {trip.trip_id: trip for trip in trips.observed_trips(session, car_id) if trip.in_map}
    kept = {
        cells.trip_id: unpack_sums(cells.sums)
        for cells in repository.cells_of(session, list(there))
        if cells.key == cells_key(there[cells.trip_id].key)
        and not period.why_not(there[cells.trip_id], cells.torque_source)
    }
    title = " ".join(
        words
        for words in (
            f"from {since:%-d %b %Y}" if since else "",
            f"until {until:%-d %b %Y}" if until else "",
        )
        if words
    )
    return Side(car_id, car_name, title or "all trips", None, {trip: there[trip].key for trip in kept}, kept)


def kept_sums(session: Session, version: MapVersion, known: Mapping[str, CellSums]) -> dict[str, CellSums] | None:
    """Return the cells of each trip of a version; None where one of its observer runs is no longer kept.

    Those in ``known``, the cells of the trips as they are now, are not unpacked again.
    """
    made_from = {trip["trip_id"]: cells_key(trip["observe_key"]) for trip in version.provenance["trips"]}
    rows = {cells.trip_id: cells for cells in repository.cells_of(session, list(made_from))}
    if any(trip not in rows or rows[trip].key != key for trip, key in made_from.items()):
        return None
    return {trip: known[trip] if trip in known else unpack_sums(rows[trip].sums) for trip in made_from}


def _day(text: str | None, name: str) -> datetime | None:
    if text is None:
        return None
    try:
        return datetime.fromisoformat(text).replace(tzinfo=UTC)
    except ValueError:
        raise Invalid("bad-map-choice", f"{text} is not a day of the calendar.", field=f"query.{name}") from None
