"""Lists by cursor: newest or greatest first, stable while rows come and go."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Generic, TypeVar

from sqlalchemy import ColumnElement, Select, and_, or_, tuple_
from sqlalchemy.orm import InstrumentedAttribute, Session

from app.errors import Invalid

MAX_LIMIT = 200
DEFAULT_LIMIT = 50

Row = TypeVar("Row")
Place = TypeVar("Place")


@dataclass(frozen=True, slots=True)
class Page(Generic[Row]):
    """Some rows of a list, and where the next ones begin; ``next_cursor`` is None on the last page."""

    items: Sequence[Row]
    next_cursor: str | None


def newest_first(
    session: Session,
    statement: Select[Row],
    created_at: InstrumentedAttribute[datetime],
    identifier: InstrumentedAttribute[str],
    cursor: str | None = None,
    limit: int = DEFAULT_LIMIT,
) -> Page[Row]:
    """Return one page of a statement's rows.

    Parameters
    ----------
    session : Session
    statement : Select
        Selects one mapped class.
    created_at, identifier : columns of that class
        The order: by time, and by identifier where times are equal.
    cursor : str, optional
        ``next_cursor`` of the page before.
    limit : int
        Rows at most.

    Raises
    ------
    Invalid
        When the cursor is not one of ours.
    """
    if cursor is not None:
        statement = statement.where(tuple_(created_at, identifier) < tuple_(*decode_cursor(cursor)))
    ordered = statement.order_by(created_at.desc(), identifier.desc()).limit(limit + 1)
    rows = session.scalars(ordered).all()
    if len(rows) <= limit:
        return Page(rows, None)
    last = rows[limit - 1]
    return Page(rows[:limit], encode_cursor(getattr(last, created_at.key), getattr(last, identifier.key)))


def greatest_first(
    session: Session,
    statement: Select[Any],
    value: ColumnElement[Any],
    identifier: InstrumentedAttribute[str],
    cursor: str | None = None,
    limit: int = DEFAULT_LIMIT,
) -> Page[Any]:
    """Return one page of a statement grouped by its identifier, as `newest_first` does, the greatest value first.

    Value and identifier are added to the rows as ``ranked_by`` and ``ranked_id``.
    """
    if cursor is not None:
        number, after = _place(cursor, float)
        statement = statement.having(or_(value < number, and_(value == number, identifier < after)))
    ranked = statement.add_columns(value.label("ranked_by"), identifier.label("ranked_id"))
    rows = session.execute(ranked.order_by(value.desc(), identifier.desc()).limit(limit + 1)).all()
    if len(rows) <= limit:
        return Page(rows, None)
    last = rows[limit - 1]
    return Page(rows[:limit], _cursor(repr(last.ranked_by), last.ranked_id))


def encode_cursor(created_at: datetime, identifier: str) -> str:
    """Return the cursor of the page after a row."""
    return _cursor(created_at.isoformat(), identifier)


def decode_cursor(cursor: str) -> tuple[datetime, str]:
    """Return the place in the list that a cursor stands for; raises `Invalid` for one that no list gave."""
    return _place(cursor, _aware)


def _aware(text: str) -> datetime:
    moment = datetime.fromisoformat(text)
    if moment.tzinfo is None:
        raise ValueError(text)
    return moment


def _cursor(place: str, identifier: str) -> str:
    return base64.urlsafe_b64encode(f"{place} {identifier}".encode()).decode().rstrip("=")


def _place(cursor: str, read: Callable[[str], Place]) -> tuple[Place, str]:
    try:
        text = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True).decode()
        place, _, identifier = text.partition(" ")
        if not identifier.isalnum():
            raise ValueError(text)
        return read(place), identifier
    except (binascii.Error, ValueError) as error:
        message = "This cursor is not one that a list gave. Begin again without a cursor."
        raise Invalid("bad-cursor", message, field="cursor") from error
