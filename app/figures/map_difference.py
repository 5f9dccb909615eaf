"""What is different between two maps, cell by cell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.figures.map_scale import ENGINE_SPEED, TORQUE
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, colour_bar, figure, remark
from app.science.arrays import BoolArray, FloatArray
from app.science.engine.compare import MapDifference
from app.science.engine.efficiency_map import CellGrid

WORSE, BETTER = {"light": "#b35806", "dark": "#f1a340"}, {"light": "#2166ac", "dark": "#67a9cf"}
SMALLEST_RANGE = 1.0
BY_CHANCE_OPACITY = 0.45


def difference_figure(difference: MapDifference, grid: CellGrid, *, theme: Theme = LIGHT) -> Json:
    """Draw second minus first in points of efficiency: strong where it is more than chance.

    Parameters
    ----------
    difference : MapDifference
    grid : CellGrid
        Cells of the two maps.
    theme : Theme
    """
    d = difference
    points = 100.0 * d.difference
    told = zip(100.0 * d.first, 100.0 * d.second, 100.0 * d.sd, strict=True)
    texts = np.array([f"{one:.1f} → {other:.1f} %, ±{sd:.1f}" for one, other, sd in told])
    shared = difference_scale(points, theme)
    bar = colour_bar(theme, "Change of η, points", nticks=5, tickangle=0, len=0.42)

    def cells(chosen: BoolArray, name: str) -> Json:
        return cells_trace(grid, d.rpm[chosen], d.nm[chosen], points[chosen], texts[chosen], name) | shared

    traces: list[Json] = [
        cells(~d.significant, "may be chance")
        | {"opacity": BY_CHANCE_OPACITY, "showscale": not d.significant.any(), "colorbar": bar},
        cells(d.significant, "more than chance") | {"showscale": bool(d.significant.any()), "colorbar": bar},
        {
            "type": "scatter",
            "mode": "markers",
            "name": "more than chance",
            "x": rounded(d.rpm[d.significant], 1),
            "y": rounded(d.nm[d.significant], 1),
            "marker": {"size": 3, "color": theme.ink},
            "hoverinfo": "skip",
        },
    ]
    layout = base_layout(
        theme,
        "difference",
        margin={"l": 52, "r": 12, "t": 52, "b": 44},
        showlegend=False,
        annotations=[remark(theme, "dotted: more than chance<br>pale: may be chance")],
        xaxis=axis(theme, ENGINE_SPEED, showgrid=False),
        yaxis=axis(theme, TORQUE, rangemode="tozero", showgrid=False, zeroline=False),
        meta={"common_cells": len(d.rpm), "changed_cells": int(d.significant.sum())},
    )
    return figure(traces, layout)


def difference_scale(points: FloatArray, theme: Theme) -> Json:
    """Return the colours of differences: the same strength for better and worse, quiet around zero."""
    most = max(SMALLEST_RANGE, float(np.ceil(np.percentile(np.abs(points), 98.0))) if len(points) else 0.0)
    colours = [[0.0, WORSE[theme.name]], [0.5, theme.line], [1.0, BETTER[theme.name]]]
    return {"zmin": -most, "zmax": most, "colorscale": colours, "hoverongaps": False}


def cells_trace(
    grid: CellGrid, rpm: FloatArray, nm: FloatArray, points: FloatArray, texts: NDArray[np.str_], name: str
) -> Json:
    """Return cells as a heat map; each has a line of text to be shown when it is pointed at.

    Parameters
    ----------
    grid : CellGrid
    rpm, nm, points : array, shape (n,)
        Centres and differences; where no cell is, nothing is drawn.
    texts : array of str, shape (n,)
    name : str
    """
    column, row = grid.column(rpm), grid.row(nm)
    i0, j0 = (int(index.min()) if len(index) else 0 for index in (column, row))
    shape = (int(row.max(initial=j0)) - j0 + 1, int(column.max(initial=i0)) - i0 + 1)
    table, told = np.full(shape, np.nan), np.full(shape, None, dtype=object)
    table[row - j0, column - i0] = points
    told[row - j0, column - i0] = texts
    return {
        "type": "heatmap",
        "name": name,
        "x": rounded(grid.centre_rpm(np.arange(i0, i0 + shape[1])), 1),
        "y": rounded(grid.centre_nm(np.arange(j0, j0 + shape[0])), 1),
        "z": rounded(table, 2),
        "customdata": told.tolist(),
        "hovertemplate": f"%{{z:+.1f}} points ({name})<br>%{{customdata}}<br>%{{x:.0f}} rpm, %{{y:.0f}} Nm"
        "<extra></extra>",
    }
