"""Pages of the trips."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/trips")
def trips_page(request: Request) -> Response:
    """List the trips of all cars."""
    return render(request, "trips.html")


@router.get("/trips/{trip_id}")
def trip_page(request: Request, trip_id: str) -> Response:
    """Show one trip on the map and over time."""
    return render(request, "trip.html", trip_id=trip_id)
