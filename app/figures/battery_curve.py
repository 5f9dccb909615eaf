"""The open-circuit curve: as it is configured, as it was fitted, and where the pack has been on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from app.figures.battery_documents import AS_PERCENT, DrawnBattery, as_array
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure
from app.science.battery.curve import OpenCircuit, voltage_at

POINTS = 201
BINS = 50
HEIGHT_PX = 340
ROOM = 4.0
"""How many times the highest bar the axis of the bars is high: they stay at the bottom."""
NO_CURVE = "This battery has no open-circuit curve yet."


def curve_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw the configured curve, with the state of charge over which the newest estimate has been."""
    ocv = (drawn.config or {}).get("ocv")
    if not ocv:
        return empty_figure(theme, "battery-curve", NO_CURVE)
    between = drawn.config.get("ocv_soc_range") if drawn.config is not None else None
    traces = curve_traces(theme, open_circuit(ocv, between), "Open-circuit voltage")
    layout = curve_layout(theme)
    if drawn.has("soc"):
        traces.insert(0, _visited(theme, drawn))
        layout["yaxis2"] = {"overlaying": "y", "side": "right", "visible": False, "range": [0, ROOM * _top(drawn)]}
    return figure(traces, layout)


def proposed_figure(proposed: Mapping[str, Any], present: OpenCircuit | None, theme: Theme) -> Json:
    """Draw a curve that is being edited or was fitted, beside the present one.

    Parameters
    ----------
    proposed : mapping
        With ``ocv`` and, of a fit, the rows ``soc`` and ``volts`` with charging less discharging voltage, ``spread_v``.
    present : OpenCircuit or None
    theme : Theme
    """
    traces = _directions(theme, proposed) if proposed.get("spread_v") else []
    if present is not None:
        traces += curve_traces(theme, present, "Present curve", "other")
    traces += curve_traces(theme, open_circuit(proposed["ocv"], proposed.get("ocv_soc_range")), "New curve")
    return figure(traces, curve_layout(theme) | {"showlegend": True})


def open_circuit(ocv: Sequence[Any], between: Sequence[float] | None = None) -> OpenCircuit:
    """Return a configuration's curve: coefficients or rows."""
    if isinstance(ocv[0], (int, float)):
        low, high = between or (0.0, 1.0)
        return OpenCircuit(coefficients=tuple(map(float, ocv)), soc_range=(float(low), float(high)))
    return OpenCircuit(points=tuple((float(soc), float(volts)) for soc, volts in ocv))


def curve_traces(theme: Theme, curve: OpenCircuit, name: str, role: str = "drive") -> list[Json]:
    """Return a curve as a line, and the rows of a table as marks on it."""
    soc = np.linspace(*curve.soc_range, POINTS)
    line: Json = {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": rounded(AS_PERCENT * soc, 3),
        "y": rounded(voltage_at(curve.pieces, soc), 5),
        "line": {"color": theme.trace, "width": 1.8}
        if role == "drive"
        else {"color": theme.quiet, "width": 1.4, "dash": "dash"},
        "hovertemplate": f"{name}: %{{y:.4f}} V at %{{x:.1f}} %<extra></extra>",
    }
    if not curve.points or role != "drive":
        return [line]
    rows = np.array(curve.points)
    marks = line | {
        "mode": "markers",
        "name": "Rows of the table",
        "x": rounded(AS_PERCENT * rows[:, 0], 3),
        "y": rounded(rows[:, 1], 5),
        "marker": {"size": 6, "color": theme.trace},
        "hovertemplate": "row: %{y:.4f} V at %{x:.1f} %<extra></extra>",
    }
    return [line, marks]


def _visited(theme: Theme, drawn: DrawnBattery) -> Json:
    shares, centres = _shares(drawn)
    return {
        "type": "bar",
        "name": "Where the pack has been, % of the time",
        "x": rounded(centres, 2),
        "y": rounded(shares, 3),
        "yaxis": "y2",
        "marker": {"color": theme.accent, "opacity": 0.35},
        "hovertemplate": "%{y:.1f} % of the time near %{x:.0f} %<extra></extra>",
    }


def _shares(drawn: DrawnBattery) -> tuple[Any, Any]:
    """Return per cent of the time in each step of the state of charge, and the steps' middles."""
    soc, t_s = AS_PERCENT * drawn.column("soc"), drawn.column("t_s")
    weights = np.diff(t_s, append=t_s[-1]) if len(t_s) > 1 else np.ones(1)
    counts, edges = np.histogram(soc[np.isfinite(soc)], BINS, (0.0, 100.0), weights=weights[np.isfinite(soc)])
    return AS_PERCENT * counts / max(float(counts.sum()), 1e-9), 0.5 * (edges[:-1] + edges[1:])


def _top(drawn: DrawnBattery) -> float:
    return max(float(_shares(drawn)[0].max()), 1.0)


def _directions(theme: Theme, proposed: Mapping[str, Any]) -> list[Json]:
    """Return the voltages while charging and discharging, between which the fitted curve goes."""
    x = rounded(AS_PERCENT * as_array(proposed["soc"]), 3)
    volts, half = as_array(proposed["volts"]), 0.5 * as_array(proposed["spread_v"])
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "name": name,
            "x": x,
            "y": rounded(volts + sign * half, 5),
            "line": {"color": theme.series[1], "width": 1, "dash": dash},
            "hovertemplate": f"{name.lower()}: %{{y:.4f}} V at %{{x:.1f}} %<extra></extra>",
        }
        for name, sign, dash in (("Charging", 1.0, "solid"), ("Discharging", -1.0, "dot"))
    ]


def curve_layout(theme: Theme, revision: str = "battery-curve") -> Json:
    """Return the layout of volts over the state of charge."""
    return base_layout(
        theme,
        revision,
        height=HEIGHT_PX,
        showlegend=False,
        bargap=0,
        margin={"l": 56, "r": 12, "t": 12, "b": 44},
        xaxis=axis(theme, "State of charge, %", range=[-2, 102], zeroline=False),
        yaxis=axis(theme, "Volts of one cell", zeroline=False),
    )
