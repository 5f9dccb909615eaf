"""The migrations make exactly the tables that the code maps, and take them away again."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator
from pathlib import Path

import pytest
import structlog
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from sqlalchemy import inspect, select

from app.accounts.models import DEFAULT_FLEET_ID, Fleet
from app.observability import configure_logging
from app.settings import Settings
from app.storage.database import Database, open_engine
from app.storage.migrate import MIGRATIONS, migrate
from app.storage.resources import Resources
from app.tables import METADATA


def test_migrated_tables_are_the_mapped_ones(resources: Resources) -> None:
    with resources.database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, METADATA) == []


def test_the_default_fleet_is_there(resources: Resources) -> None:
    with resources.database.system_transaction() as session:
        assert session.scalars(select(Fleet.id)).all() == [DEFAULT_FLEET_ID]


def test_migrating_again_changes_nothing(settings: Settings) -> None:
    migrate(settings)
    migrate(settings)


@pytest.fixture
def logging_as_before() -> Iterator[None]:
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    yield
    root.handlers[:] = handlers
    root.setLevel(level)
    structlog.reset_defaults()


def test_a_start_tells_of_a_migration_in_one_line_and_else_says_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], logging_as_before: None
) -> None:
    settings = Settings(data_dir=tmp_path, log_json=True)
    configure_logging(settings)
    migrate(settings)
    (line,) = capsys.readouterr().err.splitlines()
    said = json.loads(line)
    assert (said["event"], said["from_revision"]) == ("the database was brought up to date", None)
    migrate(settings)
    assert capsys.readouterr().err == ""


def test_downgrading_leaves_nothing(settings: Settings) -> None:
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    engine = open_engine(settings.database)
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.downgrade(config, "base")
    assert inspect(engine).get_table_names() == ["alembic_version"]
    engine.dispose()


def test_every_table_of_a_fleet_says_so() -> None:
    shared = {"fleets", "login_failures"}
    without_owner = {table.name for table in METADATA.sorted_tables if "fleet_id" not in table.columns}
    assert without_owner == shared


def test_a_folder_with_a_percent_sign_can_be_migrated(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "100% mine")
    migrate(settings)
    database = Database(settings.database)
    database.check()
    database.close()
