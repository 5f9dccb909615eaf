"""Errors become problem+json answers, or pages for who looks at pages. Bad input is never answered with a 500."""

from __future__ import annotations

from functools import partial
from http import HTTPStatus
from typing import Any

import structlog
from fastapi import FastAPI, Request, Response
from fastapi.encoders import jsonable_encoder
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, OperationalError
from starlette.exceptions import HTTPException

from app.errors import Conflict, Invalid, PonthyError, StorageFull, from_os, from_science, problem
from app.problem_pages import problem_page, wants_page
from app.science.errors import ScienceError

MEDIA_TYPE = "application/problem+json"

log = structlog.get_logger(__name__)


class ProblemDocument(BaseModel):
    """What went wrong (RFC 9457), with the place in the input where it is known."""

    model_config = ConfigDict(
        extra="allow",
        json_schema_extra={
            "example": {
                "type": "urn:ponthy:problem:bad-car-xml",
                "title": "Bad car XML",
                "status": 422,
                "detail": "mass wet: 'heavy' is not a number; write kilograms, for example 844kg.",
                "code": "bad-car-xml",
                "instance": "/api/v1/cars",
                "line": 12,
                "element": "ponthy_config/mass",
            }
        },
    )

    type: str = Field(description="URN of the kind of problem.")
    title: str = Field(description="The kind of problem in words.")
    status: int = Field(description="HTTP status.")
    detail: str = Field(description="What was wrong, where, and what to do.")
    code: str = Field(description="Short stable name of the kind of problem.")
    instance: str | None = Field(None, description="Path of the request.")
    line: int | None = Field(None, description="Line of an XML document.")
    element: str | None = Field(None, description="Element of an XML document.")
    offset: int | None = Field(None, description="Byte offset in a file.")
    row: int | None = Field(None, description="Row of a table, the header being row 1.")
    field: str | None = Field(None, description="Field of the request, or column of a table.")
    path: str | None = Field(None, description="Path of a field of a drive problem, such as `vehicle.mass_kg`.")
    pointer: str | None = Field(None, description="The same field as a JSON pointer inside the problem (RFC 6901).")
    limit: str | None = Field(None, description="Path of the limit that no drive can keep, or of two that clash.")
    limits: list[str] | None = Field(None, description="The same, one by one; `pointer` leads to the first.")


def _documented(description: str) -> dict[str, Any]:
    return {
        "description": description,
        "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}},
    }


PROBLEM_RESPONSES: dict[int | str, dict[str, Any]] = {
    "4XX": _documented("The request can't be done as it is; the problem says why."),
    "422": _documented("A value of the request is wrong; the problem says which."),
    "507": _documented("The server's disk is full."),
}
"""Answers every route may give besides its own."""


def answer(error: PonthyError, request: Request) -> Response:
    """Return the answer of an error: a page to a browser that asked for one, else problem+json."""
    page = problem_page(error, request) if wants_page(request) else None
    if page is not None:
        return page
    document = jsonable_encoder(problem(error, request.url.path))
    return JSONResponse(document, error.status, {**error.headers}, media_type=MEDIA_TYPE)


def describe(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI description of an application, with the shape of its problems in it."""
    description = FastAPI.openapi(app)
    shapes = description.setdefault("components", {}).setdefault("schemas", {})
    shapes["ProblemDocument"] = ProblemDocument.model_json_schema()
    return description


def install(app: FastAPI) -> None:
    """Have every error of an application answered as problem+json, and described as such."""
    app.openapi = partial(describe, app)  # type: ignore[method-assign]  # the way FastAPI documents
    app.add_exception_handler(PonthyError, _ponthy_error)
    app.add_exception_handler(ScienceError, _science_error)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(HTTPException, _http_exception)
    app.add_exception_handler(OSError, _os_error)
    app.add_exception_handler(DBAPIError, _database_error)


def _ponthy_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, PonthyError)  # noqa: S101 - registered for this class only
    return answer(error, request)


def _science_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, ScienceError)  # noqa: S101 - registered for this class only
    return answer(from_science(error), request)


def _validation_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)  # noqa: S101 - registered for this class only
    faults = [{"field": ".".join(str(part) for part in e["loc"]), "message": e["msg"]} for e in error.errors()]
    detail = "; ".join(f"{fault['field']}: {fault['message']}" for fault in faults[:5])
    first = faults[0]["field"] if faults else ""
    if wants_page(request) and first.startswith("path."):  # no page has such an address
        return _http_exception(request, HTTPException(HTTPStatus.NOT_FOUND))
    return answer(PonthyError("invalid-request", detail, 422, field=first, errors=faults[:50]), request)


def _http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 - registered for this class only
    phrase = HTTPStatus(error.status_code).phrase
    detail = str(error.detail)
    if error.status_code == HTTPStatus.NOT_FOUND and detail == phrase:
        detail = f"Nothing is at {request.url.path}."
    code = phrase.lower().replace(" ", "-")
    return answer(PonthyError(code, detail, error.status_code, headers=dict(error.headers or {})), request)


def _os_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, OSError)  # noqa: S101 - registered for this class only
    known = from_os(error)
    return unexpected(request, error) if known is None else answer(known, request)


def _database_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, DBAPIError)  # noqa: S101 - registered for this class only
    text = str(error.orig)
    if "disk is full" in text or "No space left" in text:
        return answer(StorageFull(), request)
    if isinstance(error, DataError):
        message = "A value of the request can't be stored: it is too large, or not text."
        return answer(Invalid("unstorable-value", message), request)
    if isinstance(error, IntegrityError):
        message = "What this request is about was changed or removed meanwhile. Look again, then try again."
        return answer(Conflict("changed-meanwhile", message), request)
    if isinstance(error, OperationalError):
        log.error("database did not answer", path=request.url.path, exc_info=error)
        busy = "The database doesn't answer at the moment. Try again in a few seconds."
        return answer(PonthyError("database-busy", busy, 503, headers={"Retry-After": "5"}), request)
    return unexpected(request, error)


def unexpected(request: Request, error: Exception) -> Response:
    """Log a fault of our own and return an answer that says so, without telling what it was."""
    log.error("request failed", path=request.url.path, exc_info=error)
    message = "This is a fault in Ponthy, not in your request. The server's log has the details under the request id."
    return answer(PonthyError("internal-error", message, 500), request)
