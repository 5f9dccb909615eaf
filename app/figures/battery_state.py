"""State of charge, current and voltage of a battery, and its circuit's parameters, over time."""

from __future__ import annotations

import numpy as np

from app.figures.battery_documents import AS_PERCENT, DrawnBattery, clock_of, time_axis
from app.figures.drive_panels import Line, Panel
from app.figures.drive_stack import panels_figure
from app.figures.theme import Json, Theme, empty_figure

NOT_ESTIMATED = "Nothing has been estimated of this battery yet."
NO_CURRENT = "Current and voltage were not kept with this estimate."
STATE_PX = 248
PARAMETERS: tuple[tuple[str, str, str, float, int], ...] = (
    ("capacity_ah", "Capacity", "Ah", 1.0, 4),
    ("resistance_ohm", "Series resistance", "mΩ", 1e3, 3),
    ("relaxation_capacitance_f", "Relaxation capacitance", "F", 1.0, 0),
    ("relaxation_resistance_ohm", "Relaxation resistance", "mΩ", 1e3, 3),
)
"""Name in the answer, words, unit, factor to it, decimals."""


def soc_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw the state of charge with its bands, beside what the car says of it where it does."""
    if not drawn.has("soc"):
        return empty_figure(theme, "battery-soc", NOT_ESTIMATED)
    clock = clock_of(drawn.column("t_s"))
    sd = AS_PERCENT * drawn.column("soc_sd") if drawn.has("soc_sd") else None
    lines = [Line("State of charge", clock.at(drawn.column("t_s")), AS_PERCENT * drawn.column("soc"), sd=sd)]
    if drawn.told is not None:
        told_s, told = drawn.told
        lines.append(Line("Told by the car", clock.at(told_s), AS_PERCENT * told, "other"))
    panel = Panel("State of charge", "%", 2, tuple(lines))
    return panels_figure([panel], theme, "battery-soc", clock.title, panel_px=STATE_PX)


def current_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw current, charging upwards, and voltage."""
    wanted = (("current_a", "Current, charging is positive", "A", 3), ("voltage_v", "Voltage", "V", 4))
    kept = [one for one in wanted if drawn.has(one[0])]
    if not kept:
        return empty_figure(theme, "battery-current", NOT_ESTIMATED if drawn.answer is None else NO_CURRENT)
    x, title = time_axis(drawn.column("t_s"))
    panels = [Panel(label, unit, digits, (Line(label, x, drawn.column(name)),)) for name, label, unit, digits in kept]
    return panels_figure(panels, theme, "battery-current", title, panel_px=150)


def parameters_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw the circuit's four parameters with their bands, beside what they were thought to be to begin with."""
    if not drawn.has("capacity_ah"):
        return empty_figure(theme, "battery-parameters", NOT_ESTIMATED)
    x, title = time_axis(drawn.column("t_s"))
    begun = (drawn.config or {}).get("initial") or {}
    panels = []
    for name, label, unit, factor, decimals in PARAMETERS:
        sd = factor * drawn.column(f"{name}_sd") if drawn.has(f"{name}_sd") else None
        lines = [Line(label, x, factor * drawn.column(name), sd=sd)]
        if begun.get(name) is not None:
            lines.append(Line("To begin with", x[[0, -1]], np.full(2, factor * begun[name]), "limit"))
        panels.append(Panel(label, unit, decimals, tuple(lines)))
    return panels_figure(panels, theme, "battery-parameters", title)
