"""The map stage: the included trips' cells added up to a new version of the car's map."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.jobs import service as jobs
from app.maps import repository
from app.maps.models import MapVersion, TripCells
from app.maps.packing import pack_sums, unpack_sums
from app.science.engine.cells import accumulate, build_map, merge
from app.science.engine.document import map_document
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.resolution import resolve
from app.storage.base import new_id
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.storage.tenancy import fleet_of
from app.trips import service as trips
from app.webhooks import service as webhooks

GRID = CellGrid()

Part = tuple[trips.ObservedTrip, TripCells]


def update(resources: Resources, fleet_id: str, car_id: str, progress: jobs.Progress) -> jobs.Store:
    """Bring a car's map up to date: a new version, unless it would be made from the very same trips.

    Only trips that were observed since are looked at again; of the others the sums are kept.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        kept = repository.cell_keys(session, car_id)
        stale = [trip for trip in trips.observed_trips(session, car_id) if kept.get(trip.trip_id) != _cells_key(trip)]
    fresh = []
    for number, trip in enumerate(stale):
        progress(number / len(stale), f"operating points of {trip.name}")
        fresh.append(_cells(resources, car_id, trip))
    progress(1.0, f"{sum(cells.points for cells in fresh)} operating points added")
    return lambda session: _store(resources, session, car_id, fresh)


def _cells_key(trip: trips.ObservedTrip) -> str:
    return stage_key("cells", observed=trip.key, grid=asdict(GRID))


def _cells(resources: Resources, car_id: str, trip: trips.ObservedTrip) -> TripCells:
    points = trips.operating_points_of(resources.blobs, trip)
    return TripCells(
        trip_id=trip.trip_id,
        car_id=car_id,
        key=_cells_key(trip),
        points=len(points),
        torque_source=points.torque_source,
        sums=pack_sums(accumulate(points, GRID)),
    )


def _store(resources: Resources, session: Session, car_id: str, fresh: Sequence[TripCells]) -> None:
    car = cars.config(session, car_id, lock=True)  # one map of a car at a time: the last one sees all trips
    observed = {trip.trip_id: trip for trip in trips.observed_trips(session, car_id)}
    for cells in fresh:
        if cells.trip_id in observed and cells.key == _cells_key(observed[cells.trip_id]):
            repository.put_cells(session, cells)
    cells_of = {cells.trip_id: cells for cells in repository.cells_of(session, list(observed))}
    parts = [(trip, cells_of[trip_id]) for trip_id, trip in observed.items() if trip.in_map and trip_id in cells_of]
    newest = repository.version(session, car_id, None)
    if newest is None and not any(cells.points for _, cells in parts):
        return  # nothing is known of this engine, and no map says otherwise
    code = resources.settings.code_version
    key = stage_key("map", cells=sorted(cells.key for _, cells in parts), car=car.key, code=code)
    if newest is None or newest.key != key:
        number = 1 if newest is None else newest.version + 1
        version = _version(resources, fleet_of(session), car, parts, number, key)
        session.add(version)
        webhooks.publish(session, "map.updated", _news(version))


def _version(
    resources: Resources, fleet_id: str, car: cars.CarConfig, parts: Sequence[Part], number: int, key: str
) -> MapVersion:
    resolved = resolve(merge(unpack_sums(cells.sums) for _, cells in parts), GRID)
    efficiency_map = build_map(resolved.sums, resolved.grid, car.vehicle)
    provenance = {
        "car_id": car.car_id,
        "version": number,
        "config_sha256": car.sha256,
        "code_version": resources.settings.code_version,
        "trips": [_origin(trip, cells) for trip, cells in parts],
    }
    document = map_document(efficiency_map, provenance)
    version_id = new_id()
    document_key = f"fleets/{fleet_id}/maps/{car.car_id}/{version_id}.json"
    resources.blobs.put(document_key, json.dumps(document).encode())
    return MapVersion(
        id=version_id,
        car_id=car.car_id,
        version=number,
        key=key,
        cells=len(efficiency_map.n),
        trusted_cells=int(np.isfinite(efficiency_map.efficiency).sum()),
        points=int(resolved.sums.n.sum()),
        trips=len(parts),
        best=document["best"],
        provenance=provenance,
        document_key=document_key,
    )


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
