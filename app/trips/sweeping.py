"""Removing the files of trips that are no longer there."""

from __future__ import annotations

from app.storage.resources import Resources
from app.trips import repository


def sweep(resources: Resources, fleet_id: str) -> int:
    """Remove the files whose trip or upload was deleted; return how many folders went.

    A row always comes before its files, so a folder without a row is of something deleted. Doing it again is harmless.
    """
    trips, decoded = f"fleets/{fleet_id}/trips", f"fleets/{fleet_id}/decoded"
    of_trips, of_uploads = (_names_below(resources, folder) for folder in (trips, decoded))
    with resources.database.transaction(fleet_id, read_only=True) as session:
        gone = [f"{trips}/{name}" for name in of_trips - repository.known_ids(session, of_trips)]
        gone += [f"{decoded}/{name}" for name in of_uploads - repository.known_uploads(session, of_uploads)]
    for folder in gone:
        resources.blobs.delete_below(folder)
    return len(gone)


def _names_below(resources: Resources, folder: str) -> set[str]:
    return {key.removeprefix(f"{folder}/").partition("/")[0] for key in resources.blobs.keys(folder)}
