"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ExistingFile = Annotated[Path, typer.Argument(exists=True, dir_okay=False, readable=True)]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Data = Annotated[Path | None, typer.Option("--data", file_okay=False, help="Folder of the service's data.")]
FleetName = Annotated[
    str | None, typer.Option("--fleet", help="Name or identifier of the fleet; else the default one.")
]
