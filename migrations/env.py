"""How Alembic reaches the database: over the connection it is given, or, called by hand, the one of the settings."""

from __future__ import annotations

from typing import Any

from alembic import context
from sqlalchemy import Connection

from app.settings import Settings
from app.storage.base import UtcDateTime
from app.storage.database import open_engine
from app.tables import METADATA


def render_item(kind: str, item: Any, _context: Any) -> str | bool:
    """Write our own column type as the plain one it is in the database: a revision must not depend on our code."""
    return "sa.DateTime(timezone=True)" if kind == "type" and isinstance(item, UtcDateTime) else False


def run(connection: Connection) -> None:
    """Run the revisions that are asked for, all in one transaction."""
    context.configure(
        connection=connection,
        target_metadata=METADATA,
        render_as_batch=connection.dialect.name == "sqlite",
        render_item=render_item,
    )
    with context.begin_transaction():
        context.run_migrations()


given = context.config.attributes.get("connection")
if given is not None:
    run(given)
else:
    with open_engine(Settings().database).begin() as own:
        run(own)
