"""Every acceleration of a trip beside the drives that take least to the same speed (Sebesta 2010, Table 4.2)."""

from __future__ import annotations

from collections.abc import Sequence

from app.figures.drive_panels import KMH
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, empty_figure, figure
from app.science.eco.result import Acceleration

NOTHING = "No acceleration of this trip could be compared."


def accelerations_figure(accelerations: Sequence[Acceleration], *, theme: Theme = LIGHT) -> Json:
    """Draw by how much the best drives differ from each acceleration: in the same time, and in any.

    Parameters
    ----------
    accelerations : sequence of Acceleration
        In driving order.
    theme : Theme
    """
    known = [one for one in accelerations if one.free_percent is not None or one.same_time_percent is not None]
    if not known:
        return empty_figure(theme, "score-accelerations", NOTHING)
    minutes = [round(one.from_s / 60.0, 2) for one in known]
    told = [f"{KMH * one.from_mps:.0f} → {KMH * one.to_mps:.0f} km/h in {one.time_s:.0f} s" for one in known]
    series = (
        ("Best in the same time", [one.same_time_percent for one in known], theme.series[0], "circle"),
        ("Best in any time", [one.free_percent for one in known], theme.series[1], "diamond-open"),
    )
    traces: list[Json] = [
        {
            "type": "scatter",
            "mode": "markers",
            "name": name,
            "x": minutes,
            "y": [None if value is None else round(value, 2) for value in percent],
            "customdata": told,
            "marker": {"size": 9, "color": colour, "symbol": symbol},
            "hovertemplate": f"%{{customdata}}<br>{name}: %{{y:+.1f}} %<extra></extra>",
        }
        for name, percent, colour, symbol in series
    ]
    layout = base_layout(
        theme,
        "score-accelerations",
        margin={"l": 52, "r": 12, "t": 12, "b": 84},
        xaxis=axis(theme, "Minutes since the start", zeroline=False),
        yaxis=axis(theme, "Difference to the driven energy, %", rangemode="tozero"),
    )
    return figure(traces, layout)
