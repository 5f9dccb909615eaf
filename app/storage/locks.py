"""Locks on rows, and what is done when two transactions waited for each other."""

from __future__ import annotations

import time
from collections.abc import Callable

import structlog
from sqlalchemy.exc import OperationalError

ATTEMPTS = 5
PAUSE_S = 0.05
PASSING = frozenset({"40001", "40P01"})
"""SQLSTATE of a serialisation failure and of a deadlock: the transaction is undone and may be tried again."""

log = structlog.get_logger(__name__)


def row_lock(wanted: bool) -> dict[str, bool] | None:
    """Return the ``with_for_update`` of a row that is to be changed or only looked at.

    On PostgreSQL it is ``FOR NO KEY UPDATE``. A plain ``FOR UPDATE`` would wait for everybody who refers to the row by
    a foreign key, and two of those who both want it wait for each other for ever.
    """
    return {"key_share": True} if wanted else None


def persist(work: Callable[[], None]) -> None:
    """Run a whole transaction, again when the database undid it because it and another one waited for each other."""
    for attempt in range(1, ATTEMPTS):
        try:
            return work()
        except OperationalError as error:
            if getattr(error.orig, "sqlstate", None) not in PASSING:
                raise
            log.info("transaction undone by the database, tried again", attempt=attempt)
            time.sleep(PAUSE_S * attempt)
    return work()
