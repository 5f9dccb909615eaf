"""Removing what was worked out about drives that were deleted."""

from __future__ import annotations

from app.drives import repository
from app.drives.keys import drives_root
from app.storage.resources import Resources


def sweep(resources: Resources, fleet_id: str) -> int:
    """Remove the files of drives that are no longer there; return how many went. A row comes before its files."""
    root = drives_root(fleet_id)
    kept = {key.removeprefix(f"{root}/").split("/")[0] for key in resources.blobs.keys(root)}
    with resources.database.transaction(fleet_id, read_only=True) as session:
        deleted = kept - repository.known_ids(session, kept)
    for drive_id in deleted:
        resources.blobs.delete_below(f"{root}/{drive_id}")
    return len(deleted)
