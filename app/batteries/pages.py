"""Pages of the batteries."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.batteries import service
from app.edge import PageSession
from app.schemas import Id
from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/batteries")
def batteries_page(request: Request) -> Response:
    """List the batteries."""
    return render(request, "batteries.html")


@router.get("/batteries/report")
def battery_report_page(request: Request) -> Response:
    """Show the report's figures, redrawn from our own run."""
    return render(request, "battery_report.html")


@router.get("/batteries/{battery_id}")
def battery_page(request: Request, session: PageSession, battery_id: Id) -> Response:
    """Show one battery: what is in it now, what is left of it, and how sure one is."""
    if session is not None:
        service.get(session, battery_id)
    return render(request, "battery.html", battery_id=battery_id)
