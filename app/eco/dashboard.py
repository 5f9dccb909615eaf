"""A trip to be played on a phone on the dashboard."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.eco import repository, service
from app.errors import PonthyError
from app.figures.numbers import rounded
from app.science.eco.alongside import Along
from app.science.eco.meters import NEEDED, STEP_S, WINDOW_S, meters
from app.storage.blobs import Blobs
from app.trips import service as trips

DECIMALS = {"efficiency": 4, "efficiency_sd": 4, "to_speed": 4, "to_height": 4, "to_resistance": 4, "costate": 0}


def dashboard(session: Session, blobs: Blobs, trip_id: str) -> dict[str, Any]:
    """Return what the meters show all along a trip, and why there is no target where there is none.

    Raises
    ------
    NotFound
        When there is no such trip.
    PonthyError
        When it has no result yet, or one without speed, thrust and fuel.
    """
    trip = trips.get(session, trip_id)
    states = trips.states_of(blobs, service.observed(session, trip_id), NEEDED)
    missing = [name for name in NEEDED if name not in states]
    if missing:
        raise PonthyError("nothing-to-play", f"The trip's states lack {', '.join(missing)}; run the trip again.", 409)
    row = repository.row(session, trip_id)
    scored = row is not None and row.document_key is not None
    along = Along.from_columns(service.along(blobs, row, ())) if row is not None and scored else None
    shown = meters(states, cars.config(session, trip.car_id).vehicle, along)
    return {
        "name": trip.name,
        "started_at": None if trip.started_at is None else trip.started_at.isoformat().replace("+00:00", "Z"),
        "step_s": STEP_S,
        "window_s": WINDOW_S,
        "map_version": row.map_version if row is not None and scored else None,
        "reason": "" if scored else service.NOT_YET if row is None else row.reason,
        "columns": {name: rounded(values, DECIMALS.get(name, 2)) for name, values in asdict(shown).items()},
    }
