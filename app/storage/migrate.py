"""Brings the database to the newest revision, when the service starts."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import structlog
from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, text

from app.settings import Settings
from app.storage.database import open_engine

MIGRATIONS = Path(__file__).resolve().parents[2] / "migrations"
LOCK_NUMBER = 0x706F6E74
"""Of the lock that keeps several starting processes from migrating at once."""

log = structlog.get_logger(__name__)


def migrate(settings: Settings) -> None:
    """Bring the database of the settings to the newest revision; when it is there already, do nothing."""
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    engine = open_engine(settings.database)
    try:
        with _alone(engine, settings.data_dir), engine.begin() as connection:
            upgrade(connection)
    finally:
        engine.dispose()


def upgrade(connection: Connection) -> None:
    """Bring the database of a connection to the newest revision, in its transaction."""
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    config.attributes["connection"] = connection
    newest = ScriptDirectory.from_config(config).get_current_head()
    present = MigrationContext.configure(connection).get_current_revision()
    if present != newest:
        command.upgrade(config, "head")
        log.info("the database was brought up to date", from_revision=present, to_revision=newest)


@contextmanager
def _alone(engine: Engine, folder: Path) -> Iterator[None]:
    if engine.dialect.name == "sqlite":
        with (folder / "migration.lock").open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            yield
        return
    with engine.connect() as connection:
        connection.execute(text("SELECT pg_advisory_lock(:number)"), {"number": LOCK_NUMBER})
        yield  # the lock goes with the connection
