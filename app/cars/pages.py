"""Pages of the cars."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.cars import service
from app.edge import PageSession
from app.schemas import Id
from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/cars")
def cars_page(request: Request) -> Response:
    """List the cars and take a new one."""
    return render(request, "cars.html")


@router.get("/cars/{car_id}")
def car_page(request: Request, session: PageSession, car_id: Id) -> Response:
    """Show one car with its newest efficiency map."""
    if session is not None:
        service.get(session, car_id)
    return render(request, "car.html", car_id=car_id, map_version="latest")
