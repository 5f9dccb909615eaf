"""Pages of the trips."""

from __future__ import annotations

from dataclasses import asdict

from fastapi import APIRouter, Request, Response

from app.edge import PageSession
from app.figures.quantities import QUANTITIES
from app.schemas import Id
from app.templating import render
from app.trips import service

router = APIRouter(include_in_schema=False)


@router.get("/trips")
def trips_page(request: Request) -> Response:
    """List the trips of all cars."""
    return render(request, "trips.html")


@router.get("/trips/{trip_id}")
def trip_page(request: Request, session: PageSession, trip_id: Id) -> Response:
    """Show one trip on the map and over time; the page is told how each quantity is written."""
    trip = None if session is None else service.row(session, trip_id)
    observed = trip is not None and trip.observe_key is not None
    quantities = {name: asdict(quantity) for name, quantity in QUANTITIES.items()}
    return render(request, "trip.html", trip_id=trip_id, observed=observed, quantities=quantities)
