"""Signals over time, one panel above the other, with their uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.figures.bands import sigma_bands
from app.figures.decimate import minmax_indices
from app.figures.numbers import rounded, thousands
from app.figures.panels import BELOW_PX, Panels
from app.figures.quantities import Quantity, quantity
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, empty_figure, figure
from app.science.arrays import FloatArray
from app.science.errors import ScienceError

DEFAULT_SIGNALS = ("speed_mps", "thrust_n", "torque_nm", "engine_speed_radps", "efficiency")
PANEL_PX = 130
GAP_PX = 26
SECONDS_DECIMALS = 3


def stack_figure(
    columns: Mapping[str, FloatArray],
    signals: Sequence[str] = DEFAULT_SIGNALS,
    *,
    theme: Theme = LIGHT,
    from_s: float | None = None,
    to_s: float | None = None,
    points: int = 4000,
) -> Json:
    """Draw signals over a common time axis.

    Bands of one and two standard deviations lie behind each signal that has a column ``<name>_sd``. ``layout.meta``
    says how many samples are shown: ``badge`` in words, ``shown`` and ``total`` as numbers of the densest panel.

    Parameters
    ----------
    columns : mapping of str to array, shape (n,)
        With ``t_s``.
    signals : sequence of str
        Columns to draw, from top to bottom.
    theme : Theme
    from_s, to_s : float, optional
        Part to draw, seconds.
    points : int
        Most samples to send per signal.

    Raises
    ------
    ScienceError
        When a signal is not among the columns.
    """
    unknown = [name for name in signals if name not in columns or name == "t_s"]
    if unknown:
        raise ScienceError(f"There is no signal {unknown[0]!r} in this trip; there are: {', '.join(sorted(columns))}.")
    if not signals:
        return empty_figure(theme, "stack", "Choose a signal to see it over time.")
    t = columns["t_s"]
    part = slice(
        0 if from_s is None else int(np.searchsorted(t, from_s)),
        len(t) if to_s is None else int(np.searchsorted(t, to_s, side="right")),
    )
    time, shown = t[part], 0
    panels = Panels(len(signals), PANEL_PX, GAP_PX)
    traces: list[Json] = []
    for row, name in enumerate(signals):
        y_axis = panels.y(row)
        shape = quantity(name)
        value = shape.shown(columns[name][part])
        kept = minmax_indices(value, points)
        shown = max(shown, len(kept))
        if f"{name}_sd" in columns:
            sd = np.abs(shape.factor) * columns[f"{name}_sd"][part]
            traces += sigma_bands(shape.title, time, value, sd, shape.decimals, theme, y_axis)
        traces.append(_curve(time[kept], value[kept], shape, y_axis, theme))
    badge = f"showing {thousands(shown)} of {thousands(len(time))}" if shown < len(time) else ""
    layout = base_layout(
        theme,
        "stack",
        hovermode="x unified",
        hoversubplots="axis",
        hoverdistance=8,
        showlegend=False,
        height=panels.height,
        margin={"l": 48, "r": 12, "t": GAP_PX, "b": BELOW_PX},
        meta={"badge": badge, "shown": shown, "total": len(time), "signals": list(signals)},
        annotations=[],
        xaxis=axis(
            theme,
            "Time since the start, s",
            **panels.time_axis(),
            showspikes=True,
            spikemode="across",
            spikethickness=1,
            spikedash="solid",
            spikecolor=theme.quiet,
            hoverformat=".1f",
            unifiedhovertitle={"text": "%{x} s"},
        ),
    )
    for row, name in enumerate(signals):
        shape = quantity(name)
        layout[panels.axis_entry(row)] = axis(
            theme,
            anchor="x",
            domain=panels.domain(row),
            nticks=5,
            zeroline=False,
            range=_span(shape.shown(columns[name][part])),
        )
        layout["annotations"].append(panels.heading(row, shape.label, shape.unit, theme))
    return figure(traces, layout)


def _span(value: FloatArray) -> list[float] | None:
    """Return a panel's range: all of the curve. A band that knows little may leave it, or the curve would vanish."""
    known = value[np.isfinite(value)]
    if not len(known):
        return None
    low, high = float(known.min()), float(known.max())
    margin = 0.06 * (high - low) or 0.5
    return [low - margin, high + margin]


def _curve(t_s: FloatArray, value: FloatArray, shape: Quantity, y_axis: str, theme: Theme) -> Json:
    unit = f" {shape.unit}" if shape.unit else ""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": shape.title,
        "x": rounded(t_s, SECONDS_DECIMALS),
        "y": rounded(value, shape.decimals),
        "xaxis": "x",
        "yaxis": y_axis,
        "line": {"color": theme.trace, "width": 1.4, "shape": "hv" if shape.stepped else "linear"},
        "hovertemplate": f"{shape.label} %{{y:.{shape.decimals}f}}{unit}<extra></extra>",
    }
