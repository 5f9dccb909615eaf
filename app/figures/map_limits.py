"""What bounds an engine's field in the figure of its map: full load and idle."""

from __future__ import annotations

import numpy as np

from app.figures.numbers import rounded
from app.figures.theme import Json, Theme
from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import EfficiencyMap, Idle

IDLE_HEIGHT = 0.3


def full_load_lines(efficiency_map: EfficiencyMap, theme: Theme) -> list[Json]:
    """Draw the highest torque by engine speed: solid, with a band of two deviations, where it was reached."""
    m = efficiency_map
    reached = np.zeros(len(m.full_load_rpm), np.bool_) if m.full_load_reached is None else m.full_load_reached
    traces: list[Json] = []
    if reached.any() and m.full_load_sd is not None:
        traces.append(_band(m.full_load_rpm, m.full_load_nm, np.where(reached, m.full_load_sd, np.nan), theme))
        text = "full load: %{y:.0f} ± %{customdata:.1f} Nm at %{x:.0f} rpm<extra></extra>"
        deviation = {"customdata": rounded(2.0 * np.where(reached, m.full_load_sd, np.nan), 1)}
        traces.append(_line(m, reached, theme) | deviation | {"name": "full load", "hovertemplate": text})
    bound = ~reached | _next_to(~reached)
    if not reached.all():
        text = "at least %{y:.0f} Nm at %{x:.0f} rpm, maybe more<extra></extra>"
        dotted = {"name": "highest seen, maybe not full load", "hovertemplate": text}
        traces.append(_line(m, bound, theme) | dotted)
        traces[-1]["line"] = traces[-1]["line"] | {"dash": "dot"}
    return traces


def idle_line(idle: Idle | None, top_nm: float, theme: Theme) -> list[Json]:
    """Draw the engine speed at idle as an upright line from the bottom; nothing where it is unknown."""
    if idle is None:
        return []
    words = f"idle: {idle.rpm:.0f} rpm, {idle.litres_per_hour:.2f} L/h"
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": words,
            "x": [round(idle.rpm, 1)] * 2,
            "y": [0, round(IDLE_HEIGHT * top_nm, 1)],
            "line": {"color": theme.doubtful, "width": 2, "dash": "dash"},
            "hovertemplate": f"{words}<br>seen for {idle.seconds:.0f} s<extra></extra>",
        }
    ]


def _line(m: EfficiencyMap, shown: BoolArray, theme: Theme) -> Json:
    return {
        "type": "scatter",
        "mode": "lines",
        "x": rounded(m.full_load_rpm, 1),
        "y": rounded(np.where(shown, m.full_load_nm, np.nan), 1),
        "line": {"color": theme.ink, "width": 1.8},
    }


def _band(rpm: FloatArray, nm: FloatArray, sd: FloatArray, theme: Theme) -> Json:
    """Fill two deviations to each side of every stretch whose deviation is known."""
    known = np.flatnonzero(np.isfinite(sd))
    x: list[float | None] = []
    y: list[float | None] = []
    for stretch in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1):
        around = np.concatenate((stretch, stretch[::-1]))
        edge = np.concatenate((nm[stretch] + 2.0 * sd[stretch], (nm[stretch] - 2.0 * sd[stretch])[::-1]))
        x += [*rounded(rpm[around], 1), None]
        y += [*rounded(edge, 1), None]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": "full load ±2σ",
        "x": x,
        "y": y,
        "fill": "toself",
        "fillcolor": f"rgba({theme.trace_rgb},0.25)",
        "line": {"width": 0},
        "hoverinfo": "skip",
    }


def _next_to(marked: BoolArray) -> BoolArray:
    """Tell what has a marked neighbour, so that dotted and solid stretches of a line meet."""
    padded = np.concatenate(([False], marked, [False]))
    return np.asarray(padded[:-2] | padded[2:])
