"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

import typer


def web_address(url: str) -> str:
    """Check that ``--url`` is an address of a web server."""
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.netloc:
        raise typer.BadParameter(f"{url!r} is not an address such as http://localhost:8321")
    return url


ExistingFile = Annotated[Path, typer.Argument(exists=True, dir_okay=False, readable=True)]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Data = Annotated[Path | None, typer.Option("--data", file_okay=False, help="Folder of the service's data.")]
FleetName = Annotated[
    str | None, typer.Option("--fleet", help="Name or identifier of the fleet; else the default one.")
]
Url = Annotated[str, typer.Option("--url", callback=web_address, help="Where Ponthy runs.")]
Token = Annotated[str | None, typer.Option("--token", envvar="PONTHY_TOKEN", help="API token; none on loopback.")]
