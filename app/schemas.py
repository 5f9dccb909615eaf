"""Shapes that the answers and requests of several slices share."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Generic, TypeVar

from fastapi import Path, Query
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, PlainSerializer

from app.storage.paging import DEFAULT_LIMIT, MAX_LIMIT

Item = TypeVar("Item")


class Document(BaseModel):
    """A body of a request or an answer; may be made straight from a row."""

    model_config = ConfigDict(from_attributes=True, extra="ignore")


class Listing(Document, Generic[Item]):
    """One page of a list."""

    items: list[Item]
    next_cursor: str | None = Field(None, description="Give this as `cursor` to get the next page; null on the last.")


def _printable(text: str) -> str:
    if any(ord(letter) < 32 or 0xD800 <= ord(letter) <= 0xDFFF for letter in text):
        raise ValueError("control characters are not allowed; write plain text on one line")
    return text.strip()


Line = Annotated[str, AfterValidator(_printable)]
"""Text on one line, trimmed."""

Name = Annotated[Line, Field(min_length=1, max_length=200)]

Moment = Annotated[datetime, PlainSerializer(lambda moment: moment.isoformat().replace("+00:00", "Z"), return_type=str)]
"""A time in UTC, written with a Z."""

Id = Annotated[str, Path(pattern="^[0-9a-f]{32}$", description="Identifier: 32 hexadecimal digits.")]
Cursor = Annotated[str | None, Query(max_length=200, description="`next_cursor` of the page before.")]
Limit = Annotated[int, Query(ge=1, le=MAX_LIMIT, description="Rows at most.")]
__all__ = ["DEFAULT_LIMIT", "Cursor", "Document", "Id", "Limit", "Line", "Listing", "Moment", "Name"]
