"""Figures of a car's health, made on request from its newest assessment."""

from __future__ import annotations

from app.figures.health_trend import trend_figure
from app.figures.theme import Json, empty_figure, theme_named
from app.health import service
from app.health.models import Assessment
from app.science.health.result import Quantity

NOTHING = "Too few trips yet to say what is usual."


def draw(assessment: Assessment | None, name: Quantity, theme: str) -> Json:
    """Return the trend of a quantity, or why there is none."""
    found, look = service.found(assessment), theme_named(theme)
    trend = None if found is None else next((one for one in found.trends if one.quantity == name), None)
    if found is None or trend is None:
        return empty_figure(look, f"health-{name}", NOTHING)
    return trend_figure(trend, found.alerts, theme=look)
