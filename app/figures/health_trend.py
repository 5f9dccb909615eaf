"""How one quantity of a car's health went, trip by trip, beside what is usual for the car."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, figure
from app.science.health.result import HealthAlert, Trend

HEIGHT_PX = 260
MOST_TICKS = 5
AROUND = 1.25
"""How far the axis goes beyond what has to be seen."""
OPACITY = {1: 0.28, 2: 0.14}


def trend_figure(trend: Trend, alerts: Sequence[HealthAlert] = (), *, theme: Theme = LIGHT) -> Json:
    """Draw a trend: each trip's change with one and two standard deviations, the usual's band, change points.

    Trips within an alert on this quantity are drawn as filled squares, others as circles. ``customdata`` holds what
    is told of a trip and its identifier, by which the page links it.

    Parameters
    ----------
    trend : Trend
    alerts : sequence of HealthAlert
        Of all quantities, open and cleared.
    theme : Theme
    """
    number = np.arange(1, len(trend.trip_ids) + 1)
    estimate, sd = np.array(trend.estimate), np.array(trend.sd)
    traces = [
        *_band(theme, number, estimate, sd, 2),
        *_band(theme, number, estimate, sd, 1),
        _trips(theme, trend, number, alerts),
    ]
    reach = AROUND * max(trend.band, float(np.max(np.abs(estimate) + np.minimum(sd, trend.band), initial=0.0)))
    layout = layout_by_trip(
        theme,
        f"health-{trend.quantity}",
        trend.started_at,
        yaxis=axis(theme, f"From the usual, {trend.unit}", range=[-reach, reach], zeroline=False),
        shapes=[*_usual(theme, trend), *(_change_line(theme, at) for at in _places(trend))],
        annotations=[_change_mark(theme, at) for at in _places(trend)],
    )
    return figure(traces, layout)


def _band(theme: Theme, x: Any, estimate: Any, sd: Any, sigmas: int) -> list[Json]:
    shared = {"type": "scatter", "mode": "lines", "hoverinfo": "skip", "line": {"width": 0}, "showlegend": False}
    edges = [
        shared | {"name": f"±{sigmas}σ", "x": rounded(x, 0), "y": rounded(estimate + sign * sigmas * sd, 2)}
        for sign in (-1, 1)
    ]
    edges[1] |= {"fill": "tonexty", "fillcolor": f"rgba({theme.trace_rgb},{OPACITY[sigmas]})"}
    return edges


def _trips(theme: Theme, trend: Trend, number: Any, alerts: Sequence[HealthAlert]) -> Json:
    alarmed = _alarmed(trend, alerts)
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": f"{trend.title}, change",
        "x": rounded(number, 0),
        "y": rounded(np.array(trend.estimate), 2),
        "customdata": [
            [trip, f"{name}{date_after(at)}", f"±{sd:.1f} {trend.unit} (1σ){', alert' if red else ''}"]
            for trip, name, at, sd, red in zip(
                trend.trip_ids, trend.names, trend.started_at, trend.sd, alarmed, strict=True
            )
        ],
        "line": {"color": theme.trace, "width": 1},
        "marker": {
            "size": 9,
            "symbol": ["square" if red else "circle" for red in alarmed],
            "color": [theme.bad if red else theme.trace for red in alarmed],
        },
        "hovertemplate": f"%{{customdata[1]}}<br>%{{y:+.1f}} {trend.unit} %{{customdata[2]}}<extra></extra>",
    }


def _alarmed(trend: Trend, alerts: Sequence[HealthAlert]) -> list[bool]:
    """Whether each trip lies within an alert on this quantity, from its first trip on until it was cleared."""
    place = {trip: at for at, trip in enumerate(trend.trip_ids)}
    spans = [
        (place.get(alert.since_trip_id, 0), place.get(alert.cleared_trip_id or "", len(place)))
        for alert in alerts
        if alert.quantity == trend.quantity
    ]
    return [any(begin <= at < end for begin, end in spans) for at in range(len(trend.trip_ids))]


def _usual(theme: Theme, trend: Trend) -> list[Json]:
    """The usual as a line, and the band in which healthy trips lie between dotted ones."""
    line = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": "y", "layer": "below"}
    band = line | {"type": "rect", "y0": trend.usual - trend.band, "y1": trend.usual + trend.band}
    return [
        band | {"fillcolor": theme.line, "opacity": 0.5, "line": {"width": 0}},
        line | {"y0": trend.usual, "y1": trend.usual, "line": {"color": theme.quiet, "width": 1.5, "dash": "dot"}},
    ]


def _places(trend: Trend) -> list[float]:
    """Between which trips the quantity changed, as places on the axis."""
    return [trend.trip_ids.index(trip) + 0.5 for trip in trend.change_points if trip in trend.trip_ids]


def _change_line(theme: Theme, at: float) -> Json:
    line = {"color": theme.bad, "width": 1.5, "dash": "dash"}
    return {"type": "line", "xref": "x", "x0": at, "x1": at, "yref": "paper", "y0": 0, "y1": 1, "line": line}


def _change_mark(theme: Theme, at: float) -> Json:
    return {
        "text": "changed",
        "xref": "x",
        "x": at,
        "yref": "paper",
        "y": 1,
        "yanchor": "bottom",
        "showarrow": False,
        "font": {"size": 12, "color": theme.bad},
    }


def layout_by_trip(theme: Theme, name: str, started_at: Sequence[float | None], **more: Any) -> Json:
    """Return the layout of a figure over trips, with a few of them named by number and date, as a phone has room."""
    count = len(started_at)
    places = sorted({round(at) for at in np.linspace(1, count, min(count, MOST_TICKS))}) if count else []
    texts = [f"{at}{date_after(started_at[at - 1], '<br>', '%-d %b')}" for at in places]
    ticks = {"tickvals": places, "ticktext": texts, "tickangle": 0}
    return base_layout(
        theme,
        name,
        height=HEIGHT_PX,
        margin={"l": 48, "r": 12, "t": 24, "b": 56},
        showlegend=False,
        xaxis=axis(theme, "Trip", range=[0.5, max(count, 2) + 0.5], showgrid=False, zeroline=False, **ticks),
        **more,
    )


def date_after(utc_s: float | None, before: str = ", ", form: str = "%-d %b %Y") -> str:
    """Return the date of a moment behind some text; nothing where it is not known."""
    return "" if utc_s is None else f"{before}{datetime.fromtimestamp(utc_s, UTC).strftime(form)}"
