"""Where a trip went, coloured by speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, log2, radians

import numpy as np

from app.figures.numbers import rounded
from app.figures.theme import (
    LIGHT,
    SPEED_FULL_SCALE_KMH,
    SPEED_SCALE,
    Json,
    Theme,
    axis,
    base_layout,
    colour_bar,
    empty_figure,
    figure,
    remark,
)
from app.science.arrays import FloatArray, IntArray

TRACK_POINTS = 2000
NOWHERE = "No position is known for this trip."
MAP_SIDE_PX = 300.0
TILE_PX = 512.0


@dataclass(frozen=True, slots=True)
class Tiles:
    """A raster tile source that was configured; without one the map has a plain background.

    Attributes
    ----------
    url : str
        With ``{z}``, ``{x}`` and ``{y}``.
    attribution : str
    """

    url: str
    attribution: str


def track_figure(columns: Mapping[str, FloatArray], *, theme: Theme = LIGHT, tiles: Tiles | None = None) -> Json:
    """Draw the track on a map that asks no other host for anything, unless tiles are given.

    Parameters
    ----------
    columns : mapping of str to array, shape (n,)
        ``t_s``, ``lat_deg``, ``lon_deg``, ``speed_mps`` and ``distance_m``.
    theme : Theme
    tiles : Tiles, optional
    """
    kept = _along(columns, ("lat_deg", "lon_deg"))
    if len(kept) < 2:
        return empty_figure(theme, "track", NOWHERE)
    lat, lon = columns["lat_deg"][kept], columns["lon_deg"][kept]
    place: Json = {"type": "scattermap", "lat": rounded(lat, 6), "lon": rounded(lon, 6)}
    traces: list[Json] = [
        place | {"mode": "lines", "line": {"width": 9, "color": theme.quiet}, "opacity": 0.4, "hoverinfo": "skip"},
        place | _coloured(columns, kept, theme, size=6),
    ]
    for at, name, fill in ((0, "start", theme.raised), (-1, "stop", theme.ink)):
        end: Json = {
            "type": "scattermap",
            "mode": "markers",
            "lat": rounded(lat[[at]], 6),
            "lon": rounded(lon[[at]], 6),
        }
        text = _end_text(columns, kept, at, name)
        traces += [
            end | {"marker": {"size": 18, "color": theme.ink}, "hoverinfo": "skip"},
            end | {"name": name, "marker": {"size": 12, "color": fill}, "hovertemplate": text},
        ]
    layout = base_layout(
        theme,
        "track",
        showlegend=False,
        margin={"l": 0, "r": 16, "t": 44, "b": 0},
        annotations=[remark(theme, "○ start  ● stop")],
        map=map_of(lat, lon, theme, tiles),
    )
    return figure(traces, layout)


def track_plan_figure(columns: Mapping[str, FloatArray], *, theme: Theme = LIGHT) -> Json:
    """Draw the track in metres north and east of the origin, for browsers that can't draw maps.

    Parameters
    ----------
    columns : mapping of str to array, shape (n,)
        ``t_s``, ``north_m``, ``east_m``, ``speed_mps`` and ``distance_m``.
    theme : Theme
    """
    kept = _along(columns, ("north_m", "east_m"))
    if len(kept) < 2:
        return empty_figure(theme, "track", NOWHERE)
    north, east = columns["north_m"][kept], columns["east_m"][kept]
    place: Json = {"type": "scatter", "x": rounded(east, 1), "y": rounded(north, 1)}
    traces: list[Json] = [
        place | {"mode": "lines", "line": {"width": 1.5, "color": theme.quiet}, "hoverinfo": "skip"},
        place | _coloured(columns, kept, theme, size=5),
    ]
    for at, name, symbol in ((0, "start", "triangle-up"), (-1, "stop", "square")):
        traces.append(
            {
                "type": "scatter",
                "mode": "markers+text",
                "name": name,
                "x": rounded(east[[at]], 1),
                "y": rounded(north[[at]], 1),
                "text": [name],
                "textposition": "top center",
                "marker": {
                    "symbol": symbol,
                    "size": 12,
                    "color": theme.ink,
                    "line": {"width": 2, "color": theme.raised},
                },
                "hovertemplate": _end_text(columns, kept, at, name),
            }
        )
    layout = base_layout(
        theme,
        "track",
        showlegend=False,
        margin={"l": 56, "r": 12, "t": 48, "b": 44},
        xaxis=axis(theme, "East, m", tickformat=",.0f"),
        yaxis=axis(theme, "North, m", tickformat=",.0f", scaleanchor="x", scaleratio=1),
    )
    return figure(traces, layout)


def _along(columns: Mapping[str, FloatArray], position: tuple[str, str]) -> IntArray:
    """Choose samples with a position, evenly along the road, so that standing costs nothing."""
    known = np.flatnonzero(np.isfinite(columns[position[0]]) & np.isfinite(columns[position[1]]))
    if len(known) <= TRACK_POINTS:
        return known
    distance = np.maximum.accumulate(np.nan_to_num(columns["distance_m"][known]))
    wanted = np.linspace(distance[0], distance[-1], TRACK_POINTS)
    chosen = np.clip(np.searchsorted(distance, wanted), 0, len(known) - 1)
    return np.asarray(known[np.unique(np.concatenate(([0], chosen, [len(known) - 1])))], dtype=np.int64)


def _coloured(columns: Mapping[str, FloatArray], kept: IntArray, theme: Theme, size: int) -> Json:
    speed = columns["speed_mps"][kept] * 3.6
    return {
        "name": "track",
        "mode": "markers",
        "customdata": rounded(columns["t_s"][kept], 1),
        "marker": {
            "size": size,
            "color": rounded(np.nan_to_num(speed), 1),
            "colorscale": SPEED_SCALE,
            "cmin": 0,
            "cmax": SPEED_FULL_SCALE_KMH,
            "showscale": True,
            "colorbar": colour_bar(theme, "Speed, km/h", tickvals=[0, 60, 120, 180]),
        },
        "hovertemplate": "%{marker.color:.0f} km/h<br>%{customdata:.0f} s after the start<extra></extra>",
    }


def _end_text(columns: Mapping[str, FloatArray], kept: IntArray, at: int, name: str) -> str:
    return f"{name}<br>{columns['t_s'][kept[at]]:.0f} s<extra></extra>"


def map_of(lat: FloatArray, lon: FloatArray, theme: Theme, tiles: Tiles | None) -> Json:
    """Return the map below a track, looking at all of it."""
    return {"style": _style(theme, tiles)} | _view(lat, lon)


def _style(theme: Theme, tiles: Tiles | None) -> Json:
    """Return a map style without fonts or sprites: those would be fetched from elsewhere."""
    background = {"id": "background", "type": "background", "paint": {"background-color": theme.line}}
    if tiles is None:
        return {"version": 8, "sources": {}, "layers": [background]}
    source = {"type": "raster", "tiles": [tiles.url], "tileSize": 256, "attribution": tiles.attribution}
    layer = {"id": "tiles", "type": "raster", "source": "tiles"}
    return {"version": 8, "sources": {"tiles": source}, "layers": [background, layer]}


def _view(lat: FloatArray, lon: FloatArray) -> Json:
    """Centre on the track, zoomed so that it fits a square of 300 px."""
    middle = 0.5 * (lat.min() + lat.max())
    width = float(lon.max() - lon.min())
    height = float(lat.max() - lat.min()) / max(cos(radians(middle)), 0.01)
    zoom = log2(360.0 * MAP_SIDE_PX / (TILE_PX * max(width, height, 1e-4)))
    centre = {"lat": round(float(middle), 6), "lon": round(float(0.5 * (lon.min() + lon.max())), 6)}
    return {"center": centre, "zoom": round(min(max(zoom, 0.0), 17.0), 2)}
