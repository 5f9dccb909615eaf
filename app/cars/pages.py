"""Pages of the cars."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/cars")
def cars_page(request: Request) -> Response:
    """List the cars and take a new one."""
    return render(request, "cars.html")


@router.get("/cars/{car_id}")
def car_page(request: Request, car_id: str) -> Response:
    """Show one car with its newest efficiency map."""
    return render(request, "car.html", car_id=car_id, map_version="latest")
