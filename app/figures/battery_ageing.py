"""Where a battery's capacity and resistance are heading: trends with bands, and when the end of life comes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from app.figures.battery_documents import AS_PERCENT, DrawnBattery, as_array
from app.figures.battery_health import end_of_life, filled, iso, soh_figure, span_of, test_marks
from app.figures.numbers import rounded
from app.figures.panels import Panels
from app.figures.theme import Json, Theme, axis, base_layout, figure
from app.science.arrays import FloatArray

SECONDS_PER_DAY = 86400.0
PANEL_PX = 200
GAP_PX = 28
WORDS = {"capacity": "Capacity", "resistance": "Series resistance"}
OF = {"capacity": "% of the rated one", "resistance": "% of what it was at first"}


def ageing_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw the trends of capacity and resistance, going on dashed beyond the last data; without them, the history."""
    ageing = drawn.ageing
    if ageing is None or ageing["capacity"]["trend"] is None:
        return soh_figure(drawn, theme)
    values = [name for name in WORDS if ageing[name]["trend"] is not None]
    wholes = {"capacity": ageing["rated_capacity_ah"], "resistance": ageing["first_resistance_ohm"]}
    rows = Panels(len(values), PANEL_PX, GAP_PX)
    layout = base_layout(
        theme,
        "battery-ageing",
        height=rows.height,
        showlegend=False,
        margin={"l": 52, "r": 12, "t": GAP_PX, "b": 44},
        xaxis=axis(theme, "Date", type="date", zeroline=False, **rows.time_axis()),
        **end_of_life(theme, drawn.threshold),
    )
    traces: list[Json] = []
    for row, name in enumerate(values):
        shares = {key: as_array(column) / wholes[name] for key, column in ageing[name]["points"].items()}
        traces += _trend(theme, ageing[name], wholes[name], name, rows.y(row))
        traces.append(_points(theme, ageing[name]["points"]["at_days"], shares, name, rows.y(row)))
        layout[rows.axis_entry(row)] = axis(
            theme, anchor="x", domain=rows.domain(row), zeroline=False, range=_range(drawn, ageing[name], shares, name)
        )
        layout["annotations"].append(rows.heading(row, WORDS[name], OF[name], theme))
    layout["shapes"] += _remaining(theme, ageing["capacity"], drawn.threshold)
    return figure([*traces, *test_marks(theme, drawn.tests)], layout)


def _trend(theme: Theme, aged: Mapping[str, Any], whole: float, name: str, y_axis: str) -> list[Json]:
    at = as_array(aged["band"]["at_days"])
    value, sd = as_array(aged["band"]["value"]) / whole, as_array(aged["band"]["sd"]) / whole
    seen = at <= aged["trend"]["to_days"] + 1e-9
    dates = _dates(at)
    bands = [part for k in (2, 1) for part in filled(theme, dates, value - k * sd, value + k * sd, k, y_axis)]
    first = max(int(seen.sum()) - 1, 0)
    parts = (("solid", slice(0, first + 1), "trend"), ("dash", slice(first, None), "trend, carried on"))
    return bands + [
        {
            "type": "scatter",
            "mode": "lines",
            "name": f"{WORDS[name]}, {words}, %",
            "x": dates[part],
            "y": rounded(AS_PERCENT * value[part], 3),
            "yaxis": y_axis,
            "line": {"color": theme.trace, "width": 1.8, "dash": dash},
            "hovertemplate": f"{words}, %{{x|%-d %b %Y}}: %{{y:.2f}} %<extra></extra>",
        }
        for dash, part, words in parts
    ]


def _points(theme: Theme, at_days: list[float], shares: Mapping[str, FloatArray], name: str, y_axis: str) -> Json:
    spread = rounded(AS_PERCENT * shares["sd"], 3)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"{WORDS[name]}, %",
        "x": _dates(as_array(at_days)),
        "y": rounded(AS_PERCENT * shares["value"], 3),
        "yaxis": y_axis,
        "error_y": {"type": "data", "array": spread, "color": theme.trace, "thickness": 1, "width": 2},
        "marker": {"size": 6, "color": theme.trace},
        "hovertemplate": "%{x|%-d %b %Y}: %{y:.2f} ±%{error_y.array:.2f} %<extra></extra>",
    }


def _range(drawn: DrawnBattery, aged: Mapping[str, Any], shares: Mapping[str, FloatArray], name: str) -> list[float]:
    """Return what an axis shows: points, trend, and of the capacity the end of life and the tests."""
    whole = shares["value"] / as_array(aged["points"]["value"])
    heights = [*shares["value"], *(as_array(aged["band"]["value"]) * whole[0])]
    if name == "capacity":
        heights += [drawn.threshold, *(test.soh for test in drawn.tests)]
    return span_of([float(height) for height in heights if np.isfinite(height)])


def _remaining(theme: Theme, aged: Mapping[str, Any], threshold: float) -> list[Json]:
    """Return between which dates the end of life is reached, as a bar upon its line."""
    left = aged["remaining"] or {}
    low, high = left.get("remaining_low_days"), left.get("remaining_high_days")
    if low is None or high is None:
        return []
    ends = _dates(aged["trend"]["to_days"] + np.array([low, high]))
    line = {"color": theme.bad, "width": 5}
    level = AS_PERCENT * threshold
    return [{"type": "line", "x0": ends[0], "x1": ends[1], "y0": level, "y1": level, "opacity": 0.6, "line": line}]


def _dates(at_days: FloatArray) -> list[str]:
    return [iso(float(day) * SECONDS_PER_DAY) for day in at_days]
