"""Fuel power over torque at a few engine speeds: cells, formula, and the measured idle."""

from __future__ import annotations

import numpy as np

from app.figures.map_scale import TORQUE
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, figure
from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import Idle
from app.science.engine.fitting.cells import RADPS_PER_RPM
from app.science.engine.fitting.family import Fitted, MapFits

SPEEDS = 4
STEPS = 25


def fit_load_figure(fits: MapFits, one: Fitted, theme: Theme = LIGHT) -> Json:
    """Draw P_in by the formula, solid between the lowest and the highest cell and dotted down to no load.

    Parameters
    ----------
    fits : MapFits
    one : Fitted
        Of these.
    theme : Theme
    """
    whole, traces = fits.efficiency_map, list[Json]()
    known = np.isfinite(whole.efficiency)
    for colour, rpm in zip(theme.series, _speeds(whole.rpm[known]), strict=False):
        here = known & (np.abs(whole.rpm - rpm) < 0.5 * whole.grid.rpm)
        nm = whole.nm[here]
        traces += [
            _line(one, rpm, np.linspace(0.0, float(nm.min()), STEPS), colour, dotted=True),
            _line(one, rpm, np.linspace(float(nm.min()), float(nm.max()), STEPS), colour, dotted=False),
            _cells(fits, here, rpm, colour),
        ]
    if fits.idle is not None:
        traces.append(_idle(fits.idle, theme))
    layout = base_layout(
        theme,
        f"fit-load-{one.formula.target}",
        xaxis=axis(theme, TORQUE, rangemode="tozero"),
        yaxis=axis(theme, "Fuel power, kW", rangemode="tozero"),
        margin={"l": 52, "r": 12, "t": 12, "b": 92},
    )
    return figure(traces, layout)


def _speeds(rpm: FloatArray) -> FloatArray:
    """Return the engine speeds of columns with many cells, spread over what was driven."""
    columns, count = np.unique(rpm, return_counts=True)
    parts = np.array_split(np.arange(len(columns)), min(SPEEDS, len(columns)))
    return np.array([columns[part[np.argmax(count[part])]] for part in parts])


def _line(one: Fitted, rpm: float, nm: FloatArray, colour: str, *, dotted: bool) -> Json:
    fuel = one.formula.fuel_power_w(np.full(len(nm), rpm * RADPS_PER_RPM), nm) / 1000.0
    return {
        "type": "scatter",
        "mode": "lines",
        "name": f"{rpm:.0f} rpm" + (", beyond the cells" if dotted else ""),
        "legendgroup": f"{rpm:.0f}",
        "showlegend": not dotted,
        "x": rounded(nm, 1),
        "y": rounded(fuel, 2),
        "line": {"color": colour, "width": 2, "dash": "dot" if dotted else "solid"},
        "hovertemplate": f"formula: %{{y:.1f}} kW<br>{rpm:.0f} rpm, %{{x:.0f}} Nm<extra></extra>",
    }


def _cells(fits: MapFits, here: BoolArray, rpm: float, colour: str) -> Json:
    whole = fits.efficiency_map
    nm, efficiency = whole.nm[here], whole.efficiency[here]
    fuel = rpm * RADPS_PER_RPM * nm / efficiency / 1000.0
    error = whole.sd[here] / np.sqrt(np.maximum(whole.n[here], 1)) / efficiency
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"cells at {rpm:.0f} rpm",
        "legendgroup": f"{rpm:.0f}",
        "showlegend": False,
        "x": rounded(nm, 1),
        "y": rounded(fuel, 2),
        "error_y": {"type": "data", "array": rounded(2.0 * fuel * np.nan_to_num(error), 2), "thickness": 1, "width": 0},
        "marker": {"color": colour, "size": 5, "opacity": 0.7},
        "hovertemplate": f"cell: %{{y:.1f}} kW<br>{rpm:.0f} rpm, %{{x:.0f}} Nm<extra></extra>",
    }


def _idle(idle: Idle, theme: Theme) -> Json:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"idle, {idle.rpm:.0f} rpm",
        "x": [0.0],
        "y": [round(idle.fuel_power_w / 1000.0, 2)],
        "error_y": {
            "type": "data",
            "array": [round(2.0 * idle.fuel_power_sd_w / 1000.0, 3)],
            "thickness": 1,
            "width": 4,
        },
        "marker": {"symbol": "diamond", "color": theme.highlight, "size": 10},
        "hovertemplate": "idle, measured: %{y:.2f} kW<extra></extra>",
    }
