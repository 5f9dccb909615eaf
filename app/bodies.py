"""Bodies of requests that are read by hand: no longer than they may be, and refused as any other body is."""

from __future__ import annotations

from typing import TypeVar

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from pydantic import TypeAdapter, ValidationError

from app.errors import PonthyError

Shape = TypeVar("Shape")


async def short_body(request: Request, most_bytes: int, code: str, what: str) -> bytes:
    """Return the body of a request; raises `PonthyError` (413) when it is too long."""
    parts: list[bytes] = []
    length = 0
    async for part in request.stream():
        length += len(part)
        if length > most_bytes:
            raise PonthyError(code, f"{what} is {most_bytes} bytes long at most; this one is longer.", 413)
        parts.append(part)
    return b"".join(parts)


def validated(shape: TypeAdapter[Shape], body: bytes) -> Shape:
    """Return what a JSON body says; raises `RequestValidationError`, as for a body that the framework reads."""
    try:
        return shape.validate_json(body)
    except ValidationError as error:
        raise RequestValidationError([{**fault, "loc": ("body", *fault["loc"])} for fault in error.errors()]) from error
