"""Bands of uncertainty behind a curve."""

from __future__ import annotations

import numpy as np

from app.figures.decimate import Band, band
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme
from app.science.arrays import FloatArray

WINDOWS = 500
OPACITY = {1: 0.2, 2: 0.13}


def sigma_bands(
    name: str, x: FloatArray, value: FloatArray, sd: FloatArray, decimals: int, theme: Theme, y_axis: str = "y"
) -> list[Json]:
    """Return the bands of two and of one standard deviation, the wider one first.

    Parameters
    ----------
    name : str
        What the curve is called.
    x, value, sd : array, shape (n,)
        NaN where the curve is interrupted.
    decimals : int
        Of the values.
    theme : Theme
    y_axis : str
        As traces call it.
    """
    return [outline(band(x, value - k * sd, value + k * sd, WINDOWS), k, name, decimals, theme, y_axis) for k in (2, 1)]


def outline(covered: Band, deviations: int, name: str, decimals: int, theme: Theme, y_axis: str = "y") -> Json:
    """Draw a band as one closed outline per stretch without a gap."""
    x: list[float | None] = []
    y: list[float | None] = []
    known = np.isfinite(covered.lower) & np.isfinite(covered.upper)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], known, [False]))))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        run = slice(start, stop)
        x += [*rounded(np.concatenate((covered.t_s[run], covered.t_s[run][::-1])), 4), None]
        y += [*rounded(np.concatenate((covered.upper[run], covered.lower[run][::-1])), decimals), None]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": f"{name}, ±{deviations}σ",
        "x": x[:-1],
        "y": y[:-1],
        "xaxis": "x",
        "yaxis": y_axis,
        "fill": "toself",
        "fillcolor": f"rgba({theme.trace_rgb},{OPACITY[deviations]})",
        "line": {"width": 0, "color": f"rgba({theme.trace_rgb},0)"},
        "hoverinfo": "skip",
        "showlegend": False,
    }
