"""Errors as pages, for a browser that asked for one: what is wrong, and where to go instead."""

from __future__ import annotations

from http import HTTPStatus

import structlog
from fastapi import Request, Response

from app.errors import PonthyError
from app.templating import render

HEADINGS = {
    401: "Not signed in",
    403: "Not allowed",
    404: "Nothing is here",
    421: "Not under this name",
    500: "A fault in Ponthy",
    503: "Not at the moment",
    507: "The disk is full",
}
SECTIONS = {"cars": "To the cars", "trips": "To the trips", "jobs": "To the jobs"}
"""First words of addresses under which there is a list to choose from, and how the way there is called."""
MOVED_ON = "It may have been removed since, or the address was not copied whole."
UNREACHABLE = frozenset({401, 421})
"""Who gets one of these can't open the pages that the frame leads to."""

log = structlog.get_logger(__name__)


def wants_page(request: Request) -> bool:
    """Whether a browser asks for a page to look at; programs and our own scripts ask for anything or for JSON."""
    path: str = request.scope["path"]
    return "text/html" in request.headers.get("accept", "") and not f"{path}/".startswith("/api/")


def problem_page(error: PonthyError, request: Request) -> Response | None:
    """Return the page that tells of an error; None when not even that can be made."""
    status = error.status
    section = request.scope["path"].split("/")[1]
    try:
        page = render(
            request,
            "problem.html",
            status=status,
            heading=HEADINGS.get(status) or HTTPStatus(status).phrase,
            detail=error.message,
            hint=MOVED_ON if status == HTTPStatus.NOT_FOUND else "",
            request_id=structlog.contextvars.get_contextvars().get("request_id") if status >= 500 else None,
            section=section,
            way_back=SECTIONS.get(section),
            framed=status not in UNREACHABLE,
        )
    except Exception as fault:  # the frame itself may be what is broken; the problem is still told
        log.error("no page for a problem", exc_info=fault)
        return None
    page.status_code = status
    page.headers.update({**error.headers, "Vary": "Accept"})
    return page
