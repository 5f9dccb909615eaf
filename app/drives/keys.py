"""Where what was worked out about drives is kept, and what removes it."""

from __future__ import annotations

SWEEP = "ponthy.sweep"
"""Name of the task that removes the files of what was deleted."""


def drives_root(fleet_id: str) -> str:
    """Return the folder of a fleet's drives."""
    return f"fleets/{fleet_id}/drives"


def result_file(fleet_id: str, drive_id: str, job_id: str) -> str:
    """Return the key of what a job found out."""
    return f"{drives_root(fleet_id)}/{drive_id}/{job_id}.json"
