"""The figures of a battery by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, get_args

from app.figures.battery_ageing import ageing_figure
from app.figures.battery_curve import curve_figure
from app.figures.battery_documents import DrawnBattery
from app.figures.battery_health import soh_figure
from app.figures.battery_residual import residual_figure
from app.figures.battery_state import current_figure, parameters_figure, soc_figure
from app.figures.theme import LIGHT, Json, Theme

BatteryFigure = Literal["soc", "soh", "parameters", "residual", "curve", "ageing", "current"]
NAMES: tuple[BatteryFigure, ...] = get_args(BatteryFigure)

MAKERS: Mapping[BatteryFigure, Callable[[DrawnBattery, Theme], Json]] = {
    "soc": soc_figure,
    "soh": soh_figure,
    "parameters": parameters_figure,
    "residual": residual_figure,
    "curve": curve_figure,
    "ageing": ageing_figure,
    "current": current_figure,
}


def battery_figure(name: BatteryFigure, drawn: DrawnBattery, *, theme: Theme = LIGHT) -> Json:
    """Draw one figure of a battery; where something is missing for it, the figure says what."""
    return MAKERS[name](drawn, theme)
