"""The map stage: the included trips' cells added up to a new version of the car's map."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.jobs import service as jobs
from app.maps import repository
from app.maps.changing import cells_changed, maps_changed, trips_changed
from app.maps.documents import efficiency_map
from app.maps.growing import Grown, added_by, grown
from app.maps.models import MapVersion, TripCells
from app.maps.rules import Rules, rules_of
from app.maps.sides import cells_key, kept_sums
from app.science.engine.document import map_document
from app.storage.base import new_id
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.storage.tenancy import fleet_of
from app.trips import service as trips
from app.webhooks import service as webhooks


@dataclass(frozen=True, slots=True)
class Ingredients:
    """What a version is made from.

    Attributes
    ----------
    car : CarConfig
    rules : Rules
    parts : list of (ObservedTrip, TripCells)
        The trips that count.
    left_out : list of (ObservedTrip, str)
        Trips that the rules leave out, and why.
    """

    car: cars.CarConfig
    rules: Rules
    parts: list[tuple[trips.ObservedTrip, TripCells]]
    left_out: list[tuple[trips.ObservedTrip, str]]

    def key(self, code: str) -> str:
        """Return the name of the version: the same ingredients make the same map."""
        cells = sorted(cells.key for _, cells in self.parts)
        return stage_key("map", cells=cells, car=self.car.key, rules=self.rules.document(), code=code)


def update(resources: Resources, fleet_id: str, car_id: str, progress: jobs.Progress) -> jobs.Store:
    """Bring a car's map up to date: a new version, unless it would be made from the very same trips.

    Only trips that were observed since are looked at again; of the others the sums are kept.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        kept = repository.cell_keys(session, car_id)
        stale = [
            trip for trip in trips.observed_trips(session, car_id) if kept.get(trip.trip_id) != cells_key(trip.key)
        ]
    fresh = []
    for number, trip in enumerate(stale):
        progress(number / len(stale), f"operating points of {trip.name}")
        fresh.append(_cells(resources, car_id, trip))
    progress(1.0, f"{sum(cells.points for cells in fresh)} operating points added")
    return lambda session: _store(resources, session, car_id, fresh)


def _cells(resources: Resources, car_id: str, trip: trips.ObservedTrip) -> TripCells:
    points = trips.operating_points_of(resources.blobs, trip)
    return TripCells(
        trip_id=trip.trip_id,
        car_id=car_id,
        key=cells_key(trip.key),
        points=len(points),
        torque_source=points.torque_source,
        sums=added_by(points),
    )


def _store(resources: Resources, session: Session, car_id: str, fresh: Sequence[TripCells]) -> None:
    car = cars.config(session, car_id, lock=True)  # one map of a car at a time: the last one sees all trips
    observed = {trip.trip_id: trip for trip in trips.observed_trips(session, car_id)}
    for cells in fresh:
        if cells.trip_id in observed and cells.key == cells_key(observed[cells.trip_id].key):
            repository.put_cells(session, cells)
    made_from = _ingredients(session, car, observed)
    newest = repository.version(session, car_id, None)
    if newest is None and not any(cells.points for _, cells in made_from.parts):
        return  # nothing is known of this engine, and no map says otherwise
    if newest is None or newest.key != made_from.key(resources.settings.code_version):
        version = _version(resources, session, made_from, newest)
        session.add(version)
        webhooks.publish(session, "map.updated", _news(version))


def _ingredients(session: Session, car: cars.CarConfig, observed: Mapping[str, trips.ObservedTrip]) -> Ingredients:
    rules = rules_of(session, car.car_id)
    cells_of = {cells.trip_id: cells for cells in repository.cells_of(session, list(observed))}
    here = [(trip, cells_of[trip_id]) for trip_id, trip in observed.items() if trip.in_map and trip_id in cells_of]
    judged = [(trip, cells, rules.why_not(trip, cells.torque_source)) for trip, cells in here]
    return Ingredients(
        car,
        rules,
        [(trip, cells) for trip, cells, why in judged if not why],
        [(trip, why) for trip, _, why in judged if why],
    )


def _version(resources: Resources, session: Session, made_from: Ingredients, before: MapVersion | None) -> MapVersion:
    number = 1 if before is None else before.version + 1
    car, parts = made_from.car, made_from.parts
    found = grown({trip.trip_id: cells.sums for trip, cells in parts}, (trip.idle for trip, _ in parts), car.vehicle)
    made = found.map
    provenance = {
        "car_id": car.car_id,
        "version": number,
        "config_sha256": car.sha256,
        "code_version": resources.settings.code_version,
        "rules": made_from.rules.document(),
        "trips": [_origin(trip, cells) for trip, cells in parts],
        "left_out": [{"trip_id": trip.trip_id, "name": trip.name, "why": why} for trip, why in made_from.left_out],
    }
    document = map_document(made, provenance)
    version_id = new_id()
    document_key = f"fleets/{fleet_of(session)}/maps/{car.car_id}/{version_id}.json"
    resources.blobs.put(document_key, json.dumps(document).encode())
    return MapVersion(
        id=version_id,
        car_id=car.car_id,
        version=number,
        key=made_from.key(resources.settings.code_version),
        cells=len(made.n),
        trusted_cells=int(np.isfinite(made.efficiency).sum()),
        points=int(made.n.sum()),
        trips=len(parts),
        best=document["best"],
        provenance=provenance,
        changes=None if before is None else _changes(resources, session, before, provenance, found),
        document_key=document_key,
    )


def _changes(
    resources: Resources, session: Session, before: MapVersion, provenance: Mapping[str, Any], now: Grown
) -> dict[str, Any]:
    kept = kept_sums(session, before, now.cells)
    if kept is None:
        cells = maps_changed(efficiency_map(resources.blobs, before), now.map)
    else:
        cells = cells_changed(kept, now.cells)
    return trips_changed(before, provenance) | cells


def _news(version: MapVersion) -> dict[str, Any]:
    names = ("car_id", "version", "trips", "points", "cells", "trusted_cells", "best")
    return {name: getattr(version, name) for name in names}


def _origin(trip: trips.ObservedTrip, cells: TripCells) -> dict[str, Any]:
    return {
        "trip_id": trip.trip_id,
        "name": trip.name,
        "points": cells.points,
        "torque_source": cells.torque_source,
        "observe_key": trip.key,
        "input_sha256": trip.provenance.get("input_sha256"),
        "tuning": trip.provenance.get("tuning", {}).get("name"),
    }
