"""Where the files of batteries lie: what was sent, and what was worked out."""

from __future__ import annotations

SWEEP = "ponthy.sweep"
"""Name of the task that removes the files of what was deleted."""


def batteries_root(fleet_id: str) -> str:
    """Return the folder of a fleet's batteries, one folder each."""
    return f"fleets/{fleet_id}/batteries"


def battery_folder(fleet_id: str, battery_id: str) -> str:
    """Return where everything of a battery lies."""
    return f"{batteries_root(fleet_id)}/{battery_id}"


def sent_file(fleet_id: str, battery_id: str, file_id: str) -> str:
    """Return the key of the bytes of a file as they were sent."""
    return f"{battery_folder(fleet_id, battery_id)}/sent/{file_id}"


def estimates_folder(fleet_id: str, battery_id: str, source_id: str) -> str:
    """Return where the answers of a trip or a file lie; they go with it."""
    return f"{battery_folder(fleet_id, battery_id)}/estimates/{source_id}"


def run_file(fleet_id: str, battery_id: str | None, job_id: str) -> str:
    """Return the key of what a job found out; without a battery it belongs to the fleet."""
    folder = f"fleets/{fleet_id}/battery-report" if battery_id is None else battery_folder(fleet_id, battery_id)
    return f"{folder}/{'runs/' if battery_id else ''}{job_id}.json"
