"""The car's efficiency map, seen from above."""

from __future__ import annotations

import numpy as np

from app.figures.map_limits import full_load_lines, idle_line
from app.figures.map_lines import best_point, operating_line, power_lines, trip_points
from app.figures.map_scale import ENGINE_SPEED, NOTHING, TORQUE, Shown, map_meta, scale_of, shown_values
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, colour_bar, empty_figure, figure, remark
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.points import OperatingPoints
from app.science.engine.raster import MapRaster, confidence, raster
from app.science.engine.reading import Peak, peak

BESIDE_RPM = 75.0


def contour_figure(
    efficiency_map: EfficiencyMap,
    *,
    shown: Shown = "efficiency",
    last_trip: OperatingPoints | None = None,
    theme: Theme = LIGHT,
) -> Json:
    """Draw the map: every trusted cell in its colour, paler where less is known, blank where nothing is.

    Over it lie isolines of the smoothed cells, full load and idle, lines of constant power, the most efficient line,
    the best point and the operating points of the last trip.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    shown : {"efficiency", "bsfc"}
        Per cent, or g/kWh.
    last_trip : OperatingPoints, optional
    theme : Theme
    """
    best = peak(efficiency_map)
    if best is None:
        return empty_figure(theme, "map", NOTHING)
    cells = raster(efficiency_map)
    values = shown_values(cells, shown)
    scale = scale_of(shown, values.cells)
    grid = {"x": rounded(cells.rpm, 1), "y": rounded(cells.nm, 1)}
    trusted = np.isfinite(cells.efficiency)
    rpm, nm = cells.rpm[trusted.any(axis=0)], cells.nm[trusted.any(axis=1)]
    top = 1.05 * float(max(efficiency_map.full_load_nm.max(), nm.max()) + 0.5 * cells.grid.nm)
    beside = 0.5 * cells.grid.rpm + BESIDE_RPM
    lowest = min(float(rpm.min()), efficiency_map.idle.rpm if efficiency_map.idle else np.inf)
    span = (lowest - beside, float(rpm.max()) + beside)
    powers = power_lines(span, top, theme)
    traces: list[Json] = [
        {
            "type": "heatmap",
            "name": scale.name,
            **grid,
            "z": rounded(values.cells, scale.decimals),
            "customdata": _count_and_deviation(cells),
            "hoverongaps": False,
            "colorbar": colour_bar(theme, scale.title, len=0.42, nticks=4, tickangle=0),
            "hovertemplate": f"%{{z:.{scale.decimals}f}} {scale.unit}<br>%{{x:.0f}} rpm, %{{y:.0f}} Nm<br>"
            "%{customdata[0]} points, scatter ±%{customdata[1]:.1f} points of efficiency<extra></extra>",
        }
        | scale.colours("zmin", "zmax"),
        _veil(cells, grid, theme),
        {
            "type": "contour",
            "name": f"isolines, every {scale.step:.0f} {scale.unit}",
            **grid,
            "z": rounded(values.smooth, scale.decimals),
            "contours": scale.isolines(theme.ink),
            "line": {"color": theme.ink, "width": 0.8},
            "opacity": 0.75,
            "showscale": False,
            "showlegend": False,
            "hoverinfo": "skip",
        },
        powers.trace,
    ]
    if last_trip is not None and len(last_trip):
        traces.append(trip_points(last_trip, theme))
    traces += [*operating_line(efficiency_map, theme), *full_load_lines(efficiency_map, theme)]
    traces += idle_line(efficiency_map.idle, top, theme)
    traces.append(best_point(best, _best_label(best, shown), theme))
    layout = base_layout(
        theme,
        f"map-{shown}",
        margin={"l": 52, "r": 46, "t": 52, "b": 110},
        annotations=[remark(theme, "fainter: less is known<br>blank: no data"), *powers.labels],
        xaxis=axis(theme, ENGINE_SPEED, range=list(span), showgrid=False),
        yaxis=axis(theme, TORQUE, range=[0, round(top, 1)], showgrid=False, zeroline=False),
        meta=map_meta(efficiency_map),
    )
    return figure(traces, layout)


def _veil(cells: MapRaster, grid: Json, theme: Theme) -> Json:
    """Cover cells with the background's colour, the more the less is known of them."""
    red, green, blue = (int(theme.raised[at : at + 2], 16) for at in (1, 3, 5))
    hidden = np.where(np.isfinite(cells.efficiency), 1.0 - confidence(cells), np.nan)
    return {
        "type": "heatmap",
        "name": "confidence",
        **grid,
        "z": rounded(hidden, 2),
        "zmin": 0,
        "zmax": 1,
        "colorscale": [[0, f"rgba({red},{green},{blue},0)"], [1, f"rgba({red},{green},{blue},0.75)"]],
        "showscale": False,
        "hoverinfo": "skip",
    }


def _count_and_deviation(cells: MapRaster) -> list[list[list[float] | None]]:
    """Return points and scatter of each trusted cell; None for the others."""
    rows = zip(cells.n.tolist(), rounded(100.0 * cells.sd, 1), np.isfinite(cells.efficiency).tolist(), strict=True)
    return [[[n, sd] if trusted else None for n, sd, trusted in zip(*row, strict=True)] for row in rows]


def _best_label(best: Peak, shown: Shown) -> str:
    return f"{best.bsfc_gpkwh:.0f} g/kWh" if shown == "bsfc" else f"{100.0 * best.efficiency:.1f} %"
