"""``./ponthy export``: trips and maps of a running Ponthy as files."""

from __future__ import annotations

from email.message import Message
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Annotated
from urllib.parse import quote, urlencode

import typer

from app.cli.options import AsJson, Token, Url
from app.cli.output import say

if TYPE_CHECKING:
    from app.cli.tus import Answer


def export(
    trip: Annotated[str | None, typer.Option(help="Identifier of the trip to export.")] = None,
    car: Annotated[str | None, typer.Option(help="Identifier of the car whose map to export.")] = None,
    version: Annotated[str, typer.Option(help="Version of the car's map.")] = "latest",
    form: Annotated[
        str, typer.Option("--format", help="Trip: kmz, csv, parquet, mat, geojson. Map: json, csv, png, svg.")
    ] = "csv",
    out: Annotated[Path | None, typer.Option(help="File or folder to write to; else the server's name, here.")] = None,
    url: Url = "http://127.0.0.1:8321",
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Save a trip or a map of a running Ponthy."""
    from app.cli.tus import Service

    if (trip is None) == (car is None):
        raise typer.BadParameter("name either --trip or --car")
    what = f"trips/{quote(trip, '')}" if trip else f"cars/{quote(car or '', '')}/maps/{quote(version, '')}"
    answer = Service(url, token).request("GET", f"/api/v1/{what}/export?{urlencode({'format': form})}")
    path = out or Path()
    if path.is_dir():
        path /= given_name(answer) or f"export.{form}"
    path.write_bytes(answer.body)
    say({"path": str(path), "bytes": len(answer.body)}, as_json, f"{path}: {len(answer.body)} bytes")


def given_name(answer: Answer) -> str:
    """Return the name the server gives the file, without any folder; empty when it gives none."""
    message = Message()
    message["Content-Disposition"] = answer.headers.get("Content-Disposition", "")
    return PurePath(message.get_filename() or "").name
