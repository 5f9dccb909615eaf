"""The database: SQLite in WAL mode or PostgreSQL, and transactions that belong to a fleet."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import structlog
from sqlalchemy import Connection, Engine, create_engine, event, make_url, text
from sqlalchemy.orm import Session, sessionmaker

from app.storage.base import Base, new_id, now
from app.storage.outbox import Message, Sender, actions, afterwards, collected, enqueue
from app.storage.tenancy import FLEET, READ_ONLY, SYSTEM, FleetOwned, FleetSession, fleet_of

__all__ = ["Base", "Database", "FleetOwned", "afterwards", "enqueue", "fleet_of", "new_id", "now", "open_engine"]

BUSY_TIMEOUT_S = 30
"""How long a writer on SQLite waits for the one before it."""

log = structlog.get_logger(__name__)


class Database:
    """An engine with its sessions.

    Parameters
    ----------
    url : str
        SQLAlchemy URL.
    sender : callable, optional
        Brings collected messages to the queue after a commit; without one they are dropped.
    """

    def __init__(self, url: str, sender: Sender | None = None) -> None:
        self.engine = open_engine(url)
        self._sender = sender
        self._writing = sessionmaker(self.engine, class_=FleetSession, expire_on_commit=False)
        reading = self.engine.execution_options(**{READ_ONLY: True})
        self._reading = sessionmaker(reading, class_=FleetSession, expire_on_commit=False, autoflush=False)

    def session(self, fleet_id: str | None, *, read_only: bool = False) -> Session:
        """Open a session for a fleet, or a system session for ``None``. The caller commits, sends and closes."""
        info: dict[Any, Any] = {READ_ONLY: read_only, SYSTEM: fleet_id is None, FLEET: fleet_id}
        return (self._reading if read_only else self._writing)(info=info)

    @contextmanager
    def transaction(self, fleet_id: str, *, read_only: bool = False) -> Iterator[Session]:
        """Give a session of a fleet; commit at the end and send what was enqueued, roll back on any error."""
        with self._edge(self.session(fleet_id, read_only=read_only)) as session:
            yield session

    @contextmanager
    def system_transaction(self, *, read_only: bool = False) -> Iterator[Session]:
        """Give a session that sees every fleet; for token look-ups, the reaper and set-up only."""
        with self._edge(self.session(None, read_only=read_only)) as session:
            yield session

    @contextmanager
    def _edge(self, session: Session) -> Iterator[Session]:
        try:
            yield session
            session.commit()
            messages, late = collected(session), actions(session)
        except BaseException:
            session.rollback()
            raise
        finally:
            session.close()
        for message in messages:
            self._send(message)
        for action in late:
            try:
                action()
            except Exception:
                log.warning("left out after a commit", exc_info=True)

    def _send(self, message: Message) -> None:
        if self._sender is None:
            return
        try:
            self._sender(message)
        except Exception:
            log.warning("message not delivered; the reaper will", task=message.task, exc_info=True)

    def check(self) -> None:
        """Raise when the database doesn't answer."""
        with self.engine.connect() as connection:
            connection.execute(text("SELECT 1"))

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()


def open_engine(url: str) -> Engine:
    """Make an engine; on SQLite writers take the write lock at once, which is what keeps them from failing."""
    parsed = make_url(url)
    if parsed.get_backend_name() != "sqlite":
        return create_engine(parsed, pool_pre_ping=True, pool_size=10, max_overflow=30)
    if parsed.database:
        Path(parsed.database).parent.mkdir(parents=True, exist_ok=True)
    engine = create_engine(
        parsed, connect_args={"timeout": BUSY_TIMEOUT_S}, pool_size=10, max_overflow=50, pool_timeout=60
    )
    event.listen(engine, "connect", _prepare_sqlite)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def _prepare_sqlite(connection: Any, _record: object) -> None:
    connection.isolation_level = None  # the driver must not begin transactions on its own; _begin_sqlite does
    cursor = connection.cursor()
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", f"busy_timeout={BUSY_TIMEOUT_S * 1000}"):
        cursor.execute(f"PRAGMA {pragma}")
    cursor.close()


def _begin_sqlite(connection: Connection) -> None:
    reads = connection.get_execution_options().get(READ_ONLY, False)
    connection.exec_driver_sql("BEGIN" if reads else "BEGIN IMMEDIATE")
