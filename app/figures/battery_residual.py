"""What the model leaves of the measured voltage: over time, and how often."""

from __future__ import annotations

import numpy as np

from app.figures.battery_documents import DrawnBattery, time_axis
from app.figures.battery_state import NOT_ESTIMATED
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure
from app.science.arrays import FloatArray

MILLI = 1e3
BINS = 41
LIMIT_SIGMAS = 5.0
LEAST_NOISE_MV = 1e-6
NO_RESIDUALS = "This estimate kept no residuals."
HEIGHT_PX = 300
PLACES = ([0.0, 0.7], [0.76, 1.0])
"""Parts of the width that time and histogram take."""


def residual_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw measured less predicted voltage: over time, and as a histogram beside what noise alone would be.

    Beyond five times the noise a point lies on the edge, with its own value when pointed at.
    """
    if drawn.answer is None or not drawn.has("residual_v"):
        return empty_figure(theme, "battery-residual", NOT_ESTIMATED if drawn.answer is None else NO_RESIDUALS)
    x, title = time_axis(drawn.column("t_s"))
    residual = MILLI * drawn.column("residual_v")
    known = np.isfinite(residual)
    x, residual = x[known], residual[known]
    noise = max(MILLI * float(drawn.answer.get("voltage_noise_v") or np.std(residual) / MILLI), LEAST_NOISE_MV)
    limit = LIMIT_SIGMAS * noise
    centres, counts = _histogram(residual, limit)
    expected = len(residual) * (centres[1] - centres[0]) * _normal(centres, noise)
    layout = base_layout(
        theme,
        "battery-residual",
        height=HEIGHT_PX,
        showlegend=False,
        margin={"l": 52, "r": 12, "t": 12, "b": 44},
        bargap=0.05,
        shapes=[_level(theme, side * 2.0 * noise) for side in (-1, 1)],
        xaxis=axis(theme, title, domain=PLACES[0], zeroline=False, range=[float(x[0]), float(x[-1])]),
        xaxis2=axis(theme, "Rows", domain=PLACES[1], rangemode="tozero", nticks=3),
        yaxis=axis(theme, "Measured less predicted, mV", range=[-1.05 * limit, 1.05 * limit]),
    )
    return figure(
        [_dots(theme, x, residual, limit), *_bars(theme, centres, counts, expected)],
        layout,
    )


def _histogram(residual: FloatArray, limit: float) -> tuple[FloatArray, FloatArray]:
    counts, edges = np.histogram(np.clip(residual, -limit, limit), bins=BINS, range=(-limit, limit))
    return 0.5 * (edges[:-1] + edges[1:]), counts.astype(np.float64)


def _normal(at: FloatArray, sd: float) -> FloatArray:
    return np.asarray(np.exp(-0.5 * (at / sd) ** 2) / (sd * np.sqrt(2.0 * np.pi)))


def _dots(theme: Theme, x: FloatArray, residual: FloatArray, limit: float) -> Json:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "Measured less predicted, mV",
        "x": rounded(x, 4),
        "y": rounded(np.clip(residual, -limit, limit), 4),
        "customdata": rounded(residual, 3),
        "marker": {"size": 3, "color": theme.trace},
        "hovertemplate": "%{customdata:.3f} mV<br>%{x}<extra></extra>",
    }


def _bars(theme: Theme, centres: FloatArray, counts: FloatArray, expected: FloatArray) -> list[Json]:
    bars: Json = {
        "type": "bar",
        "orientation": "h",
        "name": "How often",
        "x": rounded(counts, 0),
        "y": rounded(centres, 4),
        "xaxis": "x2",
        "marker": {"color": theme.trace},
        "hovertemplate": "%{x} rows near %{y:.3f} mV<extra></extra>",
    }
    line: Json = {
        "type": "scatter",
        "mode": "lines",
        "name": "Noise alone",
        "x": rounded(expected, 2),
        "y": rounded(centres, 4),
        "xaxis": "x2",
        "line": {"color": theme.highlight, "width": 1.6},
        "hovertemplate": "noise alone: %{x:.1f} rows near %{y:.3f} mV<extra></extra>",
    }
    return [bars, line]


def _level(theme: Theme, level: float) -> Json:
    line = {"color": theme.doubtful, "width": 1, "dash": "dash"}
    return {"type": "line", "xref": "x domain", "x0": 0, "x1": 1, "yref": "y", "y0": level, "y1": level, "line": line}
