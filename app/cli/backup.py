"""``./ponthy backup`` and ``./ponthy restore``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.options import AsJson, Data
from app.cli.output import say
from app.cli.service import chosen_settings, opened


def backup(
    archive: Annotated[Path, typer.Argument(dir_okay=False, help="Tar file to write; it must not exist.")],
    data: Data = None,
    as_json: AsJson = False,
) -> None:
    """Write everything that is kept to one tar file.

    The service may go on running meanwhile.
    """
    from app.cli.archive import write_archive
    from app.storage.blobs import Blobs

    settings = chosen_settings(data)
    manifest = write_archive(settings, Blobs(settings.blob_dir, settings.blob_url, settings.s3_endpoint), archive)
    say(
        manifest,
        as_json,
        f"{archive}: the database and {manifest['files']} files, {manifest['file_bytes'] / 1e6:.1f} MB",
    )


def restore(
    archive: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="Tar file made by `backup`.")],
    data: Data = None,
    as_json: AsJson = False,
) -> None:
    """Put a backup into an empty data folder.

    The data is brought up to date with this version.
    """
    from app.cli.archive import read_archive
    from app.storage.blobs import Blobs

    settings = chosen_settings(data)
    manifest = read_archive(settings, Blobs(settings.blob_dir, settings.blob_url, settings.s3_endpoint), archive)
    with opened(data):
        pass  # to open the data is to bring it up to date, and nothing else is left to do
    say(manifest, as_json, f"{settings.data_dir}: restored what was kept on {manifest['made_at']}")
