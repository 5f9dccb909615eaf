"""Removing the documents of maps whose car was deleted."""

from __future__ import annotations

from app.cars import service as cars
from app.storage.resources import Resources


def sweep(resources: Resources, fleet_id: str) -> int:
    """Remove the map documents of cars that are no longer there; return how many cars' went."""
    base = f"fleets/{fleet_id}/maps"
    of_cars = {key.removeprefix(f"{base}/").partition("/")[0] for key in resources.blobs.keys(base)}
    with resources.database.transaction(fleet_id, read_only=True) as session:
        gone = of_cars - cars.names(session, list(of_cars)).keys()
    for car_id in gone:
        resources.blobs.delete_below(f"{base}/{car_id}")
    return len(gone)
