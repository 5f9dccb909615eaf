"""How a battery's capacity went over months, and where it is heading."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from html import escape
from typing import Any

from app.figures.bands import OPACITY
from app.figures.battery_documents import AS_PERCENT, DrawnBattery, LaboratoryMark, as_array
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure

NO_HISTORY = "No trip or file has told the state of health yet."
HEIGHT_PX = 320
AROUND = 0.05


def soh_figure(drawn: DrawnBattery, theme: Theme) -> Json:
    """Draw what each trip and file says of the state of health, tests in a laboratory, and the end of life."""
    if not any(mark.soh is not None for mark in drawn.marks) and not drawn.tests:
        return empty_figure(theme, "battery-soh", NO_HISTORY)
    traces = [*_band(theme, drawn, 2), *_band(theme, drawn, 1), _marks(theme, drawn), *test_marks(theme, drawn.tests)]
    return figure(traces, _layout(theme, "battery-soh", drawn, _heights(drawn)))


def iso(at_s: float) -> str:
    """Return a moment as Plotly's date axes take it."""
    return datetime.fromtimestamp(at_s, UTC).strftime("%Y-%m-%d %H:%M:%S")


def _band(theme: Theme, drawn: DrawnBattery, sigmas: int) -> list[Json]:
    known = [mark for mark in drawn.marks if mark.soh is not None and mark.soh_sd is not None]
    if len(known) < 2:
        return []
    soh, sd = as_array([mark.soh for mark in known]), as_array([mark.soh_sd for mark in known])
    return filled(theme, [iso(mark.at_s) for mark in known], soh - sigmas * sd, soh + sigmas * sd, sigmas)


def filled(theme: Theme, x: list[str], low: Any, high: Any, sigmas: int, y_axis: str = "y") -> list[Json]:
    """Return a band between two edges, shares drawn as per cent."""
    edge: Json = {
        "type": "scatter",
        "mode": "lines",
        "x": x,
        "yaxis": y_axis,
        "hoverinfo": "skip",
        "line": {"width": 0},
    }
    lower, upper = (
        edge | {"name": f"±{sigmas}σ", "showlegend": False, "y": rounded(AS_PERCENT * y, 3)} for y in (low, high)
    )
    return [lower, upper | {"fill": "tonexty", "fillcolor": f"rgba({theme.trace_rgb},{OPACITY[sigmas]})"}]


def _marks(theme: Theme, drawn: DrawnBattery) -> Json:
    known = [mark for mark in drawn.marks if mark.soh is not None]
    sds = ["" if mark.soh_sd is None else f" ±{AS_PERCENT * mark.soh_sd:.2f} %" for mark in known]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": "State of health, %",
        "x": [iso(mark.at_s) for mark in known],
        "y": rounded(AS_PERCENT * as_array([mark.soh for mark in known]), 3),
        "customdata": [
            [mark.estimate_id, escape(mark.name, quote=False), sd] for mark, sd in zip(known, sds, strict=True)
        ],
        "line": {"color": theme.trace, "width": 1},
        "marker": {"size": 7, "color": theme.trace},
        "hovertemplate": "%{customdata[1]}, %{x|%-d %b %Y}<br>%{y:.2f} %%{customdata[2]}<extra></extra>",
    }


def test_marks(theme: Theme, tests: Sequence[LaboratoryMark]) -> list[Json]:
    if not tests:
        return []
    sds = [0.0 if test.soh_sd is None else AS_PERCENT * test.soh_sd for test in tests]
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": "Tested in a laboratory, %",
            "x": [iso(test.at_s) for test in tests],
            "y": rounded(AS_PERCENT * as_array([test.soh for test in tests]), 3),
            "error_y": {"type": "data", "array": sds, "color": theme.highlight, "thickness": 1.2, "width": 4},
            "customdata": [escape(test.note, quote=False) for test in tests],
            "marker": {"size": 10, "symbol": "diamond", "color": theme.highlight},
            "hovertemplate": "laboratory, %{x|%-d %b %Y}: %{y:.2f} %<br>%{customdata}<extra></extra>",
        }
    ]


def _heights(drawn: DrawnBattery) -> list[float]:
    return [mark.soh for mark in drawn.marks if mark.soh is not None] + [test.soh for test in drawn.tests]


def end_of_life(theme: Theme, threshold: float) -> Json:
    """Return the line at which a battery counts as worn out, and its words, as entries of a layout."""
    level = AS_PERCENT * threshold
    line = {"color": theme.bad, "width": 1.2, "dash": "dash"}
    words: Json = {"text": f"end of life, {level:.0f} %", "xref": "paper", "x": 0, "y": level, "showarrow": False}
    words |= {"xanchor": "left", "yanchor": "bottom", "font": {"size": 12, "color": theme.bad}}
    shape = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": level, "y1": level, "line": line}
    return {"shapes": [shape], "annotations": [words]}


def span_of(heights: Sequence[float]) -> list[float]:
    """Return the range of an axis in per cent that shows some shares, with a little room."""
    low, high = min(heights), max(heights)
    room = max(AROUND * (high - low), 0.01)
    return [AS_PERCENT * (low - room), AS_PERCENT * (high + room)]


def _layout(theme: Theme, name: str, drawn: DrawnBattery, heights: Sequence[float]) -> Json:
    """Return the layout over dates; the end of life is in sight."""
    return base_layout(
        theme,
        name,
        height=HEIGHT_PX,
        showlegend=False,
        margin={"l": 52, "r": 12, "t": 12, "b": 44},
        xaxis=axis(theme, "Date", type="date", zeroline=False),
        yaxis=axis(theme, "State of health, %", zeroline=False, range=span_of([*heights, drawn.threshold])),
        **end_of_life(theme, drawn.threshold),
    )
