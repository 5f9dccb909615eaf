"""What commands need of the service: its settings, its data opened, and its processes started."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from sqlalchemy.orm import Session

    from app.settings import Settings
    from app.storage.resources import Resources

ROOT = Path(__file__).resolve().parents[2]
DATA_VARIABLE = "PONTHY_DATA_DIR"


def chosen_settings(data: Path | None) -> Settings:
    """Return the settings of the environment, with the data folder of ``--data``.

    Without either, data lies in ``var`` of the checkout, from wherever the command is called. Processes that we
    start get the same folder through the environment.
    """
    from app.settings import Settings

    if data is not None:
        os.environ[DATA_VARIABLE] = str(data.resolve())
    os.environ.setdefault(DATA_VARIABLE, str(ROOT / "var"))
    return Settings()


@contextmanager
def opened(data: Path | None) -> Iterator[Resources]:
    """Open the service's data, brought up to date."""
    from app import tables
    from app.observability import configure_logging
    from app.storage.migrate import migrate
    from app.storage.resources import Resources

    assert tables.METADATA.tables  # noqa: S101 - every table is loaded, so that foreign keys find their targets
    settings = chosen_settings(data)
    configure_logging(settings)
    migrate(settings)
    resources = Resources.open(settings)
    try:
        yield resources
    finally:
        resources.close()


@contextmanager
def fleet_session(data: Path | None, fleet: str | None) -> Iterator[Session]:
    """Give a session of the fleet of that name or identifier, else of the default one; committed at the end."""
    from app.accounts import service as accounts

    with opened(data) as resources:
        with resources.database.system_transaction(read_only=True) as session:
            fleet_id = accounts.find_fleet(session, fleet or accounts.DEFAULT_FLEET_ID).id
        with resources.database.transaction(fleet_id) as session:
            yield session


def become(*arguments: str) -> NoReturn:
    """Let a process of the service take over this one; signals and the exit status are then its own."""
    command = [sys.executable, "-P", "-m", "workers", *arguments]
    os.execv(sys.executable, command)  # noqa: S606 - our own interpreter and module
