"""Page of one version of a car's efficiency map: a link that keeps showing the same numbers."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.edge import PageSession
from app.maps import service
from app.schemas import Id
from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/cars/{car_id}/maps/{version}")
def map_page(request: Request, session: PageSession, car_id: Id, version: str) -> Response:
    """Show a car with the given version of its map."""
    if session is not None:
        service.version(session, car_id, version)
    return render(request, "car.html", car_id=car_id, map_version=version)
