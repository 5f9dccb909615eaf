"""How many operating points each cell of the map has."""

from __future__ import annotations

import numpy as np

from app.figures.map_scale import ENGINE_SPEED, NOTHING, TORQUE, map_meta
from app.figures.numbers import rounded
from app.figures.theme import COUNT_SCALE, LIGHT, Json, Theme, axis, base_layout, colour_bar, empty_figure, figure
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.raster import raster


def counts_figure(efficiency_map: EfficiencyMap, *, theme: Theme = LIGHT) -> Json:
    """Draw how many operating points fell into each cell, trusted or not, on a logarithmic scale.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    theme : Theme
    """
    cells = raster(efficiency_map)
    if not cells.n.size:
        return empty_figure(theme, "counts", NOTHING)
    occupied = np.where(cells.n > 0, cells.n, np.nan)
    decades = list(range(int(np.ceil(np.log10(max(cells.n.max(), 10)))) + 1))
    trace: Json = {
        "type": "heatmap",
        "name": "points",
        "x": rounded(cells.rpm, 1),
        "y": rounded(cells.nm, 1),
        "z": rounded(np.log10(occupied), 2),
        "customdata": rounded(occupied, 0),
        "hoverongaps": False,
        "colorscale": COUNT_SCALE,
        "zmin": 0,
        "zmax": decades[-1],
        "colorbar": colour_bar(
            theme, "Operating points per cell", tickvals=decades, ticktext=[f"{10**d:,}" for d in decades]
        ),
        "hovertemplate": "%{customdata} points<br>%{x:.0f} rpm, %{y:.0f} Nm<extra></extra>",
    }
    layout = base_layout(
        theme,
        "counts",
        margin={"l": 52, "r": 12, "t": 52, "b": 44},
        showlegend=False,
        xaxis=axis(theme, ENGINE_SPEED, showgrid=False),
        yaxis=axis(theme, TORQUE, rangemode="tozero", showgrid=False, zeroline=False),
        meta=map_meta(efficiency_map),
    )
    return figure([trace], layout)
