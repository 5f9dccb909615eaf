"""Removing the files of batteries, trips and sent files that are no longer there."""

from __future__ import annotations

from app.batteries import repository
from app.batteries.keys import batteries_root
from app.storage.resources import Resources
from app.trips import service as trips


def sweep(resources: Resources, fleet_id: str) -> int:
    """Remove the folders of deleted batteries, and answers about what was deleted; return how many folders went.

    What was sent for a battery goes with it, or when somebody removes it: a file is there before its row is.
    """
    root = batteries_root(fleet_id)
    of_batteries: dict[str, str] = {}
    of_sources: dict[str, str] = {}
    for key in resources.blobs.keys(root):
        battery_id, kind, *rest = key.removeprefix(f"{root}/").split("/")
        of_batteries[battery_id] = f"{root}/{battery_id}"
        if kind == "estimates":
            of_sources[rest[0]] = f"{root}/{battery_id}/{kind}/{rest[0]}"
    with resources.database.transaction(fleet_id, read_only=True) as session:
        batteries = repository.known_ids(session, of_batteries)
        sources = repository.known_files(session, of_sources) | set(trips.names(session, list(of_sources)))
    gone = {folder for battery_id, folder in of_batteries.items() if battery_id not in batteries}
    gone |= {folder for source_id, folder in of_sources.items() if source_id not in sources}
    for folder in gone:
        resources.blobs.delete_below(folder)
    return len(gone)
