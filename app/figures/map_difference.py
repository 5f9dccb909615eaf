"""What is different between two maps, cell by cell."""

from __future__ import annotations

import numpy as np

from app.figures.map_scale import ENGINE_SPEED, TORQUE
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, colour_bar, figure, remark
from app.science.arrays import BoolArray, FloatArray
from app.science.engine.compare import MapDifference
from app.science.engine.efficiency_map import CellGrid

WORSE, BETTER = {"light": "#b35806", "dark": "#f1a340"}, {"light": "#2166ac", "dark": "#67a9cf"}
SMALLEST_RANGE = 1.0
BY_CHANCE_OPACITY = 0.35


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
    most = max(SMALLEST_RANGE, float(np.ceil(np.percentile(np.abs(points), 98.0))))
    colours = [[0.0, WORSE[theme.name]], [0.5, theme.line], [1.0, BETTER[theme.name]]]
    shared = {"zmin": -most, "zmax": most, "colorscale": colours, "hoverongaps": False}
    traces: list[Json] = [
        _cells(d, grid, ~d.significant, "may be chance") | shared | {"opacity": BY_CHANCE_OPACITY, "showscale": False},
        _cells(d, grid, d.significant, "more than chance")
        | shared
        | {"colorbar": colour_bar(theme, "Second less first, points of efficiency", nticks=5, tickangle=0)},
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


def _cells(d: MapDifference, grid: CellGrid, chosen: BoolArray, name: str) -> Json:
    column, row = grid.column(d.rpm), grid.row(d.nm)
    i0, j0 = int(column.min()), int(row.min())
    shape = (int(row.max()) - j0 + 1, int(column.max()) - i0 + 1)

    def laid_out(values: FloatArray) -> FloatArray:
        table = np.full(shape, np.nan)
        table[row[chosen] - j0, column[chosen] - i0] = values[chosen]
        return table

    texts = np.full(shape, None, dtype=object)
    told = zip(100.0 * d.first[chosen], 100.0 * d.second[chosen], 100.0 * d.sd[chosen], strict=True)
    for at_row, at_column, (one, other, sd) in zip(row[chosen] - j0, column[chosen] - i0, told, strict=True):
        texts[at_row, at_column] = f"{one:.1f} → {other:.1f} %, ±{sd:.1f}"
    return {
        "type": "heatmap",
        "name": name,
        "x": rounded(grid.centre_rpm(np.arange(i0, i0 + shape[1])), 1),
        "y": rounded(grid.centre_nm(np.arange(j0, j0 + shape[0])), 1),
        "z": rounded(laid_out(100.0 * d.difference), 2),
        "customdata": texts.tolist(),
        "hovertemplate": f"%{{z:+.1f}} points ({name})<br>%{{customdata}}<br>%{{x:.0f}} rpm, %{{y:.0f}} Nm"
        "<extra></extra>",
    }
