"""What a car burns standing still, trip by trip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.figures.health_trend import date_after, layout_by_trip
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, empty_figure, figure
from app.science.engine.efficiency_map import Idle

NOTHING = "No trip stood still with its engine running for long enough."


@dataclass(frozen=True, slots=True)
class TripIdle:
    """What one trip says of idling; ``started_at`` is UTC, seconds since 1970."""

    trip_id: str
    name: str
    started_at: float | None
    idle: Idle


def idle_figure(trips: Sequence[TripIdle], *, theme: Theme = LIGHT) -> Json:
    """Draw the idle consumption of each trip, with how far it varied within the trip, and the median of all.

    Parameters
    ----------
    trips : sequence of TripIdle
        In driving order.
    theme : Theme
    """
    if not trips:
        return empty_figure(theme, "health-idle", NOTHING)
    litres = np.array([trip.idle.litres_per_hour for trip in trips])
    spread = litres * np.array([trip.idle.fuel_power_sd_w / trip.idle.fuel_power_w for trip in trips])
    trace: Json = {
        "type": "scatter",
        "mode": "markers",
        "name": "Idle consumption",
        "x": list(range(1, len(trips) + 1)),
        "y": rounded(litres, 3),
        "error_y": {"type": "data", "array": rounded(spread, 3), "color": theme.trace, "thickness": 1, "width": 3},
        "customdata": [
            [
                trip.trip_id,
                f"{trip.name}{date_after(trip.started_at)}",
                f"{trip.idle.seconds:.0f}",
                f"{trip.idle.rpm:.0f}",
            ]
            for trip in trips
        ],
        "marker": {"size": 9, "color": theme.trace},
        "hovertemplate": (
            "%{customdata[1]}<br>%{y:.2f} L/h, varied by ±%{error_y.array:.2f}"
            "<br>%{customdata[2]} s at %{customdata[3]} rpm<extra></extra>"
        ),
    }
    median = float(np.median(litres))
    line = {"color": theme.quiet, "width": 1.5, "dash": "dot"}
    layout = layout_by_trip(
        theme,
        "health-idle",
        [trip.started_at for trip in trips],
        yaxis=axis(theme, "L/h", rangemode="tozero", zeroline=False),
        shapes=[{"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": median, "y1": median, "line": line}],
    )
    return figure([trace], layout)
