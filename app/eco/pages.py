"""The page that plays a trip on the dashboard."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.schemas import Id
from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/trips/{trip_id}/dashboard")
def dashboard_page(request: Request, trip_id: Id) -> Response:
    """Play a trip as a display in the car would have shown it."""
    return render(request, "dashboard.html", trip_id=trip_id)
