"""Figures of a car's health, made on request from its newest assessment and its trips."""

from __future__ import annotations

from typing import Literal

from sqlalchemy.orm import Session

from app.figures.health_trend import trend_figure
from app.figures.idle_trend import idle_figure
from app.figures.theme import Json, empty_figure, theme_named
from app.health import service
from app.health.idling import idle_by_trip
from app.science.health.result import Quantity

FigureName = Quantity | Literal["idle"]

NOTHING = "Too few trips yet to say what is usual."


def draw(session: Session, car_id: str, name: FigureName, theme: str) -> Json:
    """Return the trend of a quantity or of idling, or why there is none."""
    look = theme_named(theme)
    if name == "idle":
        return idle_figure(idle_by_trip(session, car_id), theme=look)
    found = service.found(service.kept(session, car_id))
    trend = None if found is None else next((one for one in found.trends if one.quantity == name), None)
    if found is None or trend is None:
        return empty_figure(look, f"health-{name}", NOTHING)
    return trend_figure(trend, found.alerts, theme=look)
