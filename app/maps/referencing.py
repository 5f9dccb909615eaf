"""Dynamometers' and manufacturers' tables beside a car's map, and its level corrected by one when somebody says so."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import Conflict, Invalid, NotFound
from app.figures.map_reference import overlay_figure, reference_difference_figure
from app.figures.map_scale import Shown
from app.figures.theme import Json, theme_named
from app.jobs.service import JobView
from app.maps import repository
from app.maps.documents import efficiency_map
from app.maps.models import MapReference, MapVersion
from app.science.engine.agreement import Agreement, agreement
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.reference import ReferenceMap, read_reference
from app.science.errors import ScienceError
from app.science.vehicle.fuels import FUELS, find_fuel
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.storage.paging import Page
from app.trips import service as trips

LARGEST_BYTES = 1_000_000
FLOW = "inj/calibration@fuelPerSecond"
OTHER_REASONS = (
    "A level that is off as a whole may have other reasons: a wrong mass, drag or rolling resistance in the car file, "
    "a fuel of another heating value, or a table of another engine or of the crankshaft without its auxiliaries.",
    "Road load can be checked by coasting on the Calibration tab, the injectors' flow by what fills the tank up.",
)
FigureName = Literal["overlay", "difference"]


@dataclass(frozen=True, slots=True)
class Beside:
    """A table beside a version of the car's map.

    Attributes
    ----------
    row : MapReference
    version : MapVersion
    table : ReferenceMap
    map : EfficiencyMap
    agreement : Agreement
    """

    row: MapReference
    version: MapVersion
    table: ReferenceMap
    map: EfficiencyMap
    agreement: Agreement

    def corrected(self) -> EfficiencyMap:
        """Return the map with its level brought to the table's."""
        scale = self.agreement.scale
        return replace(
            self.map,
            efficiency=self.map.efficiency / scale,
            sd=self.map.sd / scale,
            bsfc_gpkwh=self.map.bsfc_gpkwh * scale,
        )


@dataclass(frozen=True, slots=True)
class Correction:
    """The flow of the injectors that would bring the map's level to the table's, l/s.

    ``impossible`` says why it can't; empty when it can. ``key`` names what was looked at.
    """

    before: float
    after: float
    sd: float
    impossible: str
    key: str


@dataclass(frozen=True, slots=True)
class Applied:
    """What came of correcting the level."""

    revision: int
    note: str
    jobs: list[JobView]


def add(session: Session, car_id: str, name: str, filename: str, fuel: str | None, data: bytes) -> tuple[Any, bool]:
    """Keep a table; returns it and whether it is new: the same bytes again are the table that is there.

    Raises
    ------
    NotFound
        When there is no such car.
    SignalsError
        With the row and column of the table that can't be used.
    """
    vehicle = cars.config(session, car_id).vehicle
    known = find_fuel(vehicle.fuel_name)
    chosen = fuel or ("petrol" if known is None else known.name)
    sha256 = hashlib.sha256(data).hexdigest()
    there = repository.reference_with(session, car_id, sha256, chosen)
    if there is not None:
        return there, False
    points = len(_table(data, chosen).rpm)
    row = MapReference(
        car_id=car_id, name=name, fuel=chosen, filename=filename, sha256=sha256, points=points, data=data
    )
    session.add(row)
    session.flush()
    return row, True


def page(session: Session, car_id: str, cursor: str | None, limit: int) -> Page[MapReference]:
    """Return one page of a car's tables, newest first; raises `NotFound`."""
    cars.get(session, car_id)
    return repository.references(session, car_id, cursor, limit)


def get(session: Session, car_id: str, reference_id: str) -> MapReference:
    """Return a table with its bytes; raises `NotFound`."""
    found = repository.reference(session, car_id, reference_id)
    if found is None:
        raise NotFound("table", reference_id)
    return found


def delete(session: Session, car_id: str, reference_id: str) -> None:
    """Remove a table; raises `NotFound`."""
    session.delete(get(session, car_id, reference_id))


def beside(session: Session, blobs: Blobs, car_id: str, reference_id: str, version: MapVersion) -> Beside:
    """Lay a table over a version of the car's map.

    Raises
    ------
    NotFound
        When there is no such table.
    ScienceError
        When the two hardly overlap.
    """
    row = get(session, car_id, reference_id)
    table, drawn = _table(row.data, row.fuel), efficiency_map(blobs, version)
    found = agreement(drawn, table)
    if found is None:
        known = np.isfinite(drawn.efficiency)
        raise ScienceError(
            f"The map and the table hardly overlap: the table covers {_span(table.rpm, table.nm)}, the map's trusted "
            f"cells {_span(drawn.rpm[known], drawn.nm[known])}."
        )
    return Beside(row, version, table, drawn, found)


def _table(data: bytes, fuel: str) -> ReferenceMap:
    chosen = FUELS[fuel]
    return read_reference(data, chosen.energy_j_per_l / (1000.0 * chosen.density_kg_per_l))


def _span(rpm: Any, nm: Any) -> str:
    if not len(rpm):
        return "nothing"
    return f"{rpm.min():.0f} to {rpm.max():.0f} rpm and {nm.min():.0f} to {nm.max():.0f} Nm"


def draw(found: Beside, name: FigureName, shown: Shown, corrected: bool, theme: str) -> Json:
    """Return a figure of a table and a map, which may be shown with its level corrected."""
    drawn = found.corrected() if corrected else found.map
    if name == "overlay":
        return overlay_figure(drawn, found.table, found.row.name, shown=shown, theme=theme_named(theme))
    return reference_difference_figure(drawn, found.table, theme=theme_named(theme))


def correction(session: Session, found: Beside) -> Correction:
    """Return what bringing the map's level to the table's would mean."""
    car = cars.config(session, found.version.car_id)
    one = found.agreement
    before = car.vehicle.injection.litres_per_second
    made_from = {trip["trip_id"] for trip in found.version.provenance["trips"]}
    seen = [trip for trip in trips.observed_trips(session, car.car_id) if trip.trip_id in made_from]
    impossible = ""
    if not any(trip.counts_pulses for trip in seen):
        impossible = "The fuel of these trips is reported by the engine, so the injectors' flow changes nothing."
    elif found.version.provenance.get("config_sha256") != car.sha256:
        impossible = "This map was made with another car file. Run the trips again first, and look at the newest map."
    key = stage_key("level", car=car.key, version=found.version.key, table=found.row.sha256, fuel=found.row.fuel)
    return Correction(before, before * one.scale, before * one.scale_sd, impossible, key)


def apply(session: Session, found: Beside, key: str) -> Applied:
    """Write the injectors' flow that brings the level to the table's, as a new revision, and run all trips again.

    Raises
    ------
    Conflict
        When car file or map are others than when it was looked at.
    Invalid
        When the flow is not what decides.
    """
    now = correction(session, found)
    if key != now.key:
        raise Conflict("level-changed", "The map or the car file is another one by now. Look at the table again.")
    if now.impossible:
        raise Invalid("not-by-the-injectors", now.impossible)
    one = found.agreement
    note = (
        f"Injector flow {now.before:.6f} → {now.after:.6f} ± {now.sd:.6f} l/s, so that the map's level is that of "
        f"“{found.row.name}” (map {found.version.version} over table: {one.scale:.4f} ± {one.scale_sd:.4f})"
    )
    car_id = found.version.car_id
    car = cars.fill_form(session, car_id, {FLOW: float(f"{now.after:.8g}")}, note)
    return Applied(car.revision, note, trips.reprocess_car(session, car_id))
