"""``./ponthy upload``: files to a running Ponthy, resumed after interruptions."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import AsJson, Token, Url
from app.cli.output import note, say

if TYPE_CHECKING:
    from app.cli.tus import Service

POLL_S = 0.5
OVER = ("succeeded", "failed", "cancelled")


def upload(
    paths: Annotated[list[Path], typer.Argument(exists=True, help="Files, or folders whose files are all sent.")],
    car: Annotated[str, typer.Option(help="Identifier of the car the trips belong to.")],
    url: Url = "http://127.0.0.1:8321",
    token: Token = None,
    mapping: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Names and scales of foreign columns (JSON).")
    ] = None,
    wait: Annotated[bool, typer.Option("--wait/--no-wait", help="Wait until the trips are processed.")] = False,
    as_json: AsJson = False,
) -> None:
    """Send files to a running Ponthy.

    An interrupted transfer goes on where it stopped.
    """
    from app.cli.tus import Service

    service = Service(url, token)
    results: list[dict[str, Any]] = []
    for path in each_file(paths):
        metadata = {"filename": path.name, "car_id": car, "kind": "trip"}
        if mapping is not None:
            metadata["mapping"] = mapping.read_text(encoding="utf-8")
        result = service.send(path, metadata, progress_of(path))
        known = ", which was there already" if result.get("duplicate") else ""
        note(f"{path.name}: trip {', '.join(result['trip_ids'])}{known}")
        results.append(result)
    if wait:
        for result in results:
            result["job"] = finished(service, result["job_id"])
    lines = [f"{one['filename']}: {one.get('job', {}).get('state', one['state'])}" for one in results]
    say({"uploads": results}, as_json, "\n".join(lines))
    if any(one.get("job", {}).get("state") == "failed" for one in results):
        raise typer.Exit(1)


def progress_of(path: Path) -> Callable[[int, int], None]:
    """Return what notes how much of a file has arrived."""
    return lambda sent, size: note(f"{path.name}: {100 * sent // size} % of {size / 1e6:.1f} MB")


def each_file(paths: list[Path]) -> list[Path]:
    """Return the files named and those directly in the folders named, hidden ones left out."""
    files: list[Path] = []
    for path in paths:
        found = sorted(path.iterdir()) if path.is_dir() else [path]
        files += [file for file in found if file.is_file() and not file.name.startswith(".")]
    return files


def finished(service: Service, job_id: str | None) -> dict[str, Any]:
    """Wait for the end of a job and return it; an upload without a job has nothing to wait for."""
    while job_id:
        job: dict[str, Any] = service.insist("GET", f"/api/v1/jobs/{job_id}").json()
        if job["state"] in OVER:
            return job
        time.sleep(POLL_S)
    return {}
