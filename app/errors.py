"""What can go wrong with a request, said once: a code, a status, a sentence, and where in the input it is.

The API turns these into problem+json (RFC 9457), the command line into one line and an exit status.
"""

from __future__ import annotations

import errno
import re
from typing import Any

from app.science.errors import DecodeError, EstimatorDiverged, ScienceError, SignalsError, VehicleConfigError
from app.science.fields import ProblemError
from app.science.optimal.problem import Infeasible

Problem = dict[str, Any]


class PonthyError(Exception):
    """Something a person or a program asked for can't be done.

    Parameters
    ----------
    code : str
        Short stable name, for example ``upload-offset-conflict``.
    message : str
        What was wrong, where, and what to do.
    status : int
        HTTP status.
    headers : dict, optional
        Headers of the answer, for example ``Retry-After``.
    **where
        Where in the input it is: ``line``, ``element``, ``offset``, ``row``, ``field``…
    """

    def __init__(
        self,
        code: str,
        message: str,
        status: int = 400,
        *,
        headers: dict[str, str] | None = None,
        **where: Any,
    ) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.status = status
        self.headers = headers or {}
        self.where = where


class NotFound(PonthyError):  # noqa: N818 - reads as the condition it names
    """Nothing of that name is in this fleet."""

    def __init__(self, what: str, identifier: str) -> None:
        super().__init__("not-found", f"There is no {what} {identifier!r} in this fleet.", 404)


class Conflict(PonthyError):  # noqa: N818 - reads as the condition it names
    """The request can't be done in the present state of things."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(code, message, 409)


class Invalid(PonthyError):  # noqa: N818 - reads as the condition it names
    """A value of the request is out of bounds."""

    def __init__(self, code: str, message: str, **where: Any) -> None:
        super().__init__(code, message, 422, **where)


class StorageFull(PonthyError):  # noqa: N818 - reads as the condition it names
    """The disk is full."""

    def __init__(self) -> None:
        super().__init__(
            "storage-full",
            "The server's disk is full. What was received is kept; make room, then try again or resume the upload.",
            507,
            headers={"Retry-After": "60"},
        )


def from_science(error: ScienceError) -> PonthyError:
    """Say a complaint of the science as an error of a request: same words, same place in the input."""
    match error:
        case DecodeError():
            return Invalid("undecodable-image", str(error), offset=error.offset)
        case VehicleConfigError():
            return Invalid("bad-car-xml", str(error), line=error.line, element=error.element)
        case SignalsError():
            return Invalid("bad-signals-table", str(error), row=error.row, field=error.field)
        case EstimatorDiverged():
            return Invalid("estimator-diverged", str(error), t_s=error.t_s)
        case ProblemError():
            return Invalid(error.code, str(error), path=error.path, pointer=pointer(error.path))
        case Infeasible():
            limits = error.limit.split(", ")
            return Invalid(error.code, str(error), limit=error.limit, limits=limits, pointer=pointer(limits[0]))
        case _:
            return Invalid("unusable-input", str(error))


def pointer(path: str) -> str:
    """Return the JSON pointer (RFC 6901) of a field's path such as ``road.distance_m[3]``."""
    return "".join(f"/{step}" for step in re.findall(r"[^.\[\]]+", path))


def from_os(error: OSError) -> PonthyError | None:
    """Return the error of a request that a failed file operation stands for, or None when it is our own fault."""
    return StorageFull() if error.errno in (errno.ENOSPC, errno.EDQUOT) else None


def problem(error: PonthyError, instance: str | None = None) -> Problem:
    """Return the problem document of an error."""
    document: Problem = {
        "type": f"urn:ponthy:problem:{error.code}",
        "title": error.code.replace("-", " ").capitalize().replace("xml", "XML"),
        "status": error.status,
        "detail": error.message,
        "code": error.code,
    }
    if instance is not None:
        document["instance"] = instance
    return document | error.where


def from_problem(document: Problem) -> PonthyError:
    """Return the error that a kept problem document tells of."""
    said = {"type", "title", "status", "detail", "code", "instance"}
    where = {name: value for name, value in document.items() if name not in said}
    return PonthyError(document["code"], document["detail"], document["status"], **where)
