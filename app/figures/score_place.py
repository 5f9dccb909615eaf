"""Where on its way a trip took more than its best drive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.figures.decimate import even_indices
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, colour_bar, empty_figure, figure
from app.figures.track import NOWHERE, TRACK_POINTS, Tiles, map_of
from app.science.arrays import FloatArray, IntArray
from app.science.eco.result import Along

PER_100KM = 100.0
CUT_PERCENT = 97.0
LEAST = 0.1


def place_figure(
    along: Along, places: Mapping[str, FloatArray], *, theme: Theme = LIGHT, tiles: Tiles | None = None
) -> Json:
    """Draw the way on a map, coloured by what was lost there.

    Parameters
    ----------
    along : Along
    places : mapping of str to array, shape (n,)
        ``lat_deg`` and ``lon_deg`` of each row of ``along``.
    theme : Theme
    tiles : Tiles, optional
    """
    kept = _kept(places, "lat_deg", "lon_deg")
    if len(kept) < 2:
        return empty_figure(theme, "score-place", NOWHERE)
    lat, lon = places["lat_deg"][kept], places["lon_deg"][kept]
    trace = {"type": "scattermap", "lat": rounded(lat, 6), "lon": rounded(lon, 6)} | _coloured(along, kept, theme)
    margin = {"l": 0, "r": 16, "t": 44, "b": 0}
    layout = base_layout(theme, "score-place", showlegend=False, margin=margin, map=map_of(lat, lon, theme, tiles))
    return figure([trace], layout)


def place_plan_figure(along: Along, places: Mapping[str, FloatArray], *, theme: Theme = LIGHT) -> Json:
    """Draw the same in metres north and east of the trip's origin, for browsers that can't draw maps.

    Parameters
    ----------
    along : Along
    places : mapping of str to array, shape (n,)
        ``north_m`` and ``east_m`` of each row of ``along``.
    theme : Theme
    """
    kept = _kept(places, "north_m", "east_m")
    if len(kept) < 2:
        return empty_figure(theme, "score-place", NOWHERE)
    east, north = places["east_m"][kept], places["north_m"][kept]
    trace = {"type": "scatter", "x": rounded(east, 1), "y": rounded(north, 1)} | _coloured(along, kept, theme)
    layout = base_layout(
        theme,
        "score-place",
        showlegend=False,
        margin={"l": 56, "r": 12, "t": 48, "b": 44},
        xaxis=axis(theme, "East, m", tickformat=",.0f"),
        yaxis=axis(theme, "North, m", tickformat=",.0f", scaleanchor="x", scaleratio=1),
    )
    return figure([trace], layout)


def _kept(places: Mapping[str, FloatArray], *names: str) -> IntArray:
    if any(name not in places for name in names):
        return np.empty(0, dtype=np.int64)
    known = np.flatnonzero(np.logical_and.reduce([np.isfinite(places[name]) for name in names]))
    return known[even_indices(len(known), TRACK_POINTS)] if len(known) else known


def _coloured(along: Along, kept: IntArray, theme: Theme) -> Json:
    lost = np.nan_to_num(PER_100KM * along.lost_lpkm[kept])
    top = max(float(np.percentile(np.abs(lost), CUT_PERCENT)), LEAST)
    return {
        "name": "Lost, L/100 km",
        "mode": "markers",
        "customdata": rounded(along.t_s[kept], 1),
        "marker": {
            "size": 6,
            "color": rounded(lost, 2),
            "colorscale": [[0.0, theme.series[2]], [0.5, theme.quiet], [1.0, theme.series[1]]],
            "cmin": -top,
            "cmax": top,
            "showscale": True,
            "colorbar": colour_bar(theme, "Lost, L/100 km", nticks=5, tickangle=0),
        },
        "hovertemplate": "%{marker.color:.1f} L/100 km lost<br>%{customdata:.0f} s after the start<extra></extra>",
    }
