"""A drive among others: what its competitors burn, what every method found, and fuel against an emission."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from app.figures.drive_documents import DrawnDrive
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure

ROW_PX = 34
AROUND_PX = 84
LEAST_ERROR = 1e-12
NO_RIVALS = "No other drive came near enough to be told of."
NOT_COMPARED = "The methods have not been compared yet."


def competitors_figure(drive: DrawnDrive, theme: Theme) -> Json:
    """Draw how much more than the answer each candidate burns, per cent, and the bound below which no drive goes.

    Parameters
    ----------
    drive : DrawnDrive
    theme : Theme
    """
    fuel = float(drive.answer.get("fuel_energy_j") or 0.0)
    rows = [
        (str(one["name"]), float(one["fuel_energy_j"]))
        for one in drive.answer.get("candidates") or []
        if one.get("fuel_energy_j")
    ]
    bound = drive.answer.get("bound_j") or (drive.answer.get("certificate") or {}).get("lower_bound_j")
    if not rows or fuel <= 0.0:
        return empty_figure(theme, "drive-competitors", NO_RIVALS)
    rows = [("the answer", fuel), *rows, *([("no drive below", float(bound))] if bound else [])]
    more = [100.0 * (energy / fuel - 1.0) for _, energy in rows]
    trace: Json = {
        "type": "scatter",
        "mode": "markers",
        "name": "more than the answer, %",
        "x": [round(value, 5) for value in more],
        "y": [name for name, _ in rows],
        "customdata": [round(energy / 1000.0, 3) for _, energy in rows],
        "marker": {
            "size": 11,
            "color": theme.trace,
            "symbol": ["circle", *["diamond"] * (len(rows) - 2), "line-ns-open" if bound else "diamond"],
        },
        "hovertemplate": "%{y}: %{customdata:.1f} kJ, %{x:+.3g} %<extra></extra>",
    }
    layout = base_layout(
        theme,
        "drive-competitors",
        height=ROW_PX * len(rows) + AROUND_PX,
        margin={"l": 120, "r": 16, "t": 12, "b": 48},
        showlegend=False,
        xaxis=axis(theme, "More fuel than the answer, %"),
        yaxis=axis(theme, autorange="reversed", showgrid=True),
    )
    return figure([trace], layout)


def methods_figure(drive: DrawnDrive, theme: Theme) -> Json:
    """Draw every method's error in energy over the milliseconds it took, both on logarithmic axes.

    Parameters
    ----------
    drive : DrawnDrive
        With a comparison.
    theme : Theme
    """
    rows = [row for row in _rows(drive.comparison) if row.get("relative_error") is not None and row.get("milliseconds")]
    if not rows:
        return empty_figure(theme, "drive-methods", NOT_COMPARED)
    error = np.array([max(abs(float(row["relative_error"])), LEAST_ERROR) for row in rows])
    trace: Json = {
        "type": "scatter",
        "mode": "markers+text",
        "name": "error in energy",
        "x": [round(float(row["milliseconds"]), 4) for row in rows],
        "y": [float(f"{value:.3g}") for value in error],
        "text": [str(row["name"]).replace("_", " ") for row in rows],
        "textposition": "top center",
        "textfont": {"size": 11, "color": theme.ink},
        "cliponaxis": False,
        "marker": {"size": 9, "color": theme.trace},
        "hovertemplate": "%{text}<br>%{x:.3g} ms, off by %{y:.2g}<extra></extra>",
    }
    layout = base_layout(
        theme,
        "drive-methods",
        showlegend=False,
        margin={"l": 60, "r": 40, "t": 24, "b": 44},
        xaxis=axis(theme, "Time to solve, ms", type="log", dtick=1, exponentformat="power"),
        yaxis=axis(theme, "Error in energy, relative", type="log", dtick=1, exponentformat="power"),
    )
    return figure([trace], layout)


def _rows(comparison: Mapping[str, Any] | None) -> list[Mapping[str, Any]]:
    return [] if comparison is None else list(comparison.get("rows") or [])
