"""A dynamometer's or a manufacturer's table over a car's map."""

from __future__ import annotations

import numpy as np

from app.figures.map_contour import contour_figure
from app.figures.map_difference import cells_trace, difference_scale
from app.figures.map_scale import ENGINE_SPEED, TORQUE, Shown, scale_of, shown_values
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, colour_bar, figure
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.raster import raster
from app.science.engine.reference import ReferenceMap

COLUMNS, ROWS = 70, 50


def overlay_figure(
    efficiency_map: EfficiencyMap,
    table: ReferenceMap,
    name: str,
    *,
    shown: Shown = "efficiency",
    theme: Theme = LIGHT,
) -> Json:
    """Draw a map with the table's isolines over it, at the steps of the map's own.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    table : ReferenceMap
    name : str
        What the table is called.
    shown : {"efficiency", "bsfc"}
    theme : Theme
    """
    drawn = contour_figure(efficiency_map, shown=shown, theme=theme)
    cells = raster(efficiency_map)
    scale = scale_of(shown, shown_values(cells, shown).cells)
    rpm, nm = (np.linspace(values.min(), values.max(), n) for values, n in ((table.rpm, COLUMNS), (table.nm, ROWS)))
    efficiency = table.at(*np.meshgrid(rpm, nm))
    fuel_per_work = float(np.nanmedian(cells.bsfc_gpkwh * cells.efficiency))
    drawn["data"].append(
        {
            "type": "contour",
            "name": f"{name}, every {scale.step:.0f} {scale.unit}",
            "x": rounded(rpm, 1),
            "y": rounded(nm, 1),
            "z": rounded(fuel_per_work / efficiency if shown == "bsfc" else 100.0 * efficiency, scale.decimals),
            "contours": scale.isolines(theme.bad),
            "line": {"color": theme.bad, "width": 1.6, "dash": "dash"},
            "connectgaps": False,
            "showscale": False,
            "showlegend": True,
            "hoverinfo": "skip",
        }
    )
    top = max(drawn["layout"]["yaxis"]["range"][1], round(1.05 * float(table.nm.max()), 1))
    drawn["layout"]["yaxis"]["range"] = [0, top]
    drawn["layout"]["uirevision"] = f"beside-{shown}"
    return drawn


def reference_difference_figure(efficiency_map: EfficiencyMap, table: ReferenceMap, *, theme: Theme = LIGHT) -> Json:
    """Draw the map's trusted cells less the table, in points of efficiency.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    table : ReferenceMap
    theme : Theme
    """
    m = efficiency_map
    expected = table.at(m.rpm, m.nm)
    points = 100.0 * (m.efficiency - expected)
    both = np.isfinite(points)
    pairs = zip(100.0 * m.efficiency[both], 100.0 * expected[both], strict=True)
    told = np.array([f"map {own:.1f} %, table {other:.1f} %" for own, other in pairs])
    trace = cells_trace(m.grid, m.rpm[both], m.nm[both], points[both], told, "map less table")
    bar = colour_bar(theme, "Map less table, points", nticks=5, tickangle=0, len=0.42)
    layout = base_layout(
        theme,
        "beside-difference",
        margin={"l": 52, "r": 12, "t": 52, "b": 44},
        showlegend=False,
        xaxis=axis(theme, ENGINE_SPEED, showgrid=False),
        yaxis=axis(theme, TORQUE, rangemode="tozero", showgrid=False, zeroline=False),
    )
    return figure([trace | difference_scale(points[both], theme) | {"colorbar": bar}], layout)
