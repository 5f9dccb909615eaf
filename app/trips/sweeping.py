"""Removing the files of trips that are no longer there, and those of runs that no trip refers to any more."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from datetime import timedelta

from app.jobs import service as jobs
from app.storage.resources import Resources
from app.trips import repository
from app.trips.keys import decoded_root, results_root, shown_folders

FOLDERS_AT_ONCE = 50
REST = timedelta(days=1)
"""Outdated runs are left alone for so long, for a backup whose copy of the database still refers to them."""


def sweep(resources: Resources, fleet_id: str, rest: timedelta = REST) -> int:
    """Remove the files of deleted trips and uploads and of outdated runs; return how many folders went.

    Outdated runs go when the car's last job has been over for ``rest``. Doing it again is harmless.
    """
    return _sweep_deleted(resources, fleet_id) + _sweep_outdated(resources, fleet_id, rest)


def _sweep_deleted(resources: Resources, fleet_id: str) -> int:
    """Remove folders without a row: a row always comes before its files."""
    trips, decoded = results_root(fleet_id), decoded_root(fleet_id)
    of_trips, of_uploads = (_names_below(resources, folder) for folder in (trips, decoded))
    with resources.database.transaction(fleet_id, read_only=True) as session:
        gone = [f"{trips}/{name}" for name in of_trips - repository.known_ids(session, of_trips)]
        gone += [f"{decoded}/{name}" for name in of_uploads - repository.known_uploads(session, of_uploads)]
    for folder in gone:
        resources.blobs.delete_below(folder)
    return len(gone)


def _sweep_outdated(resources: Resources, fleet_id: str, rest: timedelta) -> int:
    """Remove what earlier code, cars or tunings made and newer results replaced, car by car."""
    runs: dict[str, set[str]] = defaultdict(set)
    for root in (results_root(fleet_id), decoded_root(fleet_id)):
        for key in resources.blobs.keys(root):
            owner, run, *file = key.removeprefix(f"{root}/").split("/")
            if file:
                runs[f"{root}/{owner}"].add(f"{root}/{owner}/{run}")
    with resources.database.transaction(fleet_id, read_only=True) as session:
        trips = repository.everything(session)
    outdated: dict[str, set[str]] = defaultdict(set)
    for trip in trips:
        for owner in (f"{results_root(fleet_id)}/{trip.id}", f"{decoded_root(fleet_id)}/{trip.upload_id}"):
            outdated[trip.car_id] |= runs[owner]
    for trip in trips:
        outdated[trip.car_id] -= shown_folders(trip)
    return sum(
        _remove_unless_needed(resources, fleet_id, car_id, piece, rest)
        for car_id, folders in outdated.items()
        for piece in _pieces(sorted(folders))
    )


def _pieces(folders: list[str]) -> Iterator[list[str]]:
    for at in range(0, len(folders), FOLDERS_AT_ONCE):
        yield folders[at : at + FOLDERS_AT_ONCE]


def _remove_unless_needed(resources: Resources, fleet_id: str, car_id: str, folders: list[str], rest: timedelta) -> int:
    """Remove folders while the car's jobs and trips are locked, and only while none of its jobs is open.

    A job that runs may write or read what no row refers to yet or any more.
    """
    with resources.database.transaction(fleet_id) as session:
        if not jobs.is_idle(session, car_id, rest):
            return 0
        shown = {folder for trip in repository.of_car_locked(session, car_id) for folder in shown_folders(trip)}
        gone = [folder for folder in folders if folder not in shown]
        for folder in gone:
            resources.blobs.delete_below(folder)
    return len(gone)


def _names_below(resources: Resources, folder: str) -> set[str]:
    return {key.removeprefix(f"{folder}/").partition("/")[0] for key in resources.blobs.keys(folder)}
