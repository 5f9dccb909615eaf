"""Where on the engine's map a trip took more than its best drive."""

from __future__ import annotations

import numpy as np

from app.figures.map_scale import ENGINE_SPEED, TORQUE
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, colour_bar, empty_figure, figure
from app.science.eco.result import TripScore

NOTHING = "The engine ran in none of the map's cells while it was scored."
CUT_PERCENT = 98.0
LEAST_ML = 0.1
ML = 1000.0


def cells_figure(score: TripScore, *, theme: Theme = LIGHT) -> Json:
    """Draw the cells, coloured by the millilitres lost while the engine ran there; saved ones in the other colour.

    Parameters
    ----------
    score : TripScore
    theme : Theme
    """
    if not score.cells:
        return empty_figure(theme, "score-cells", NOTHING)
    rpm, columns = np.unique([cell.rpm for cell in score.cells], return_inverse=True)
    nm, rows = np.unique([cell.nm for cell in score.cells], return_inverse=True)
    lost = np.array([ML * cell.lost_l for cell in score.cells])
    grid = np.full((len(nm), len(rpm)), np.nan)
    grid[rows, columns] = lost
    told = np.full(grid.shape, None, dtype=object)
    for row, column, cell in zip(rows, columns, score.cells, strict=True):
        told[row, column] = [round(cell.seconds, 1), round(ML * cell.litres, 1)]
    reach = max(float(np.percentile(np.abs(lost), CUT_PERCENT)), LEAST_ML)
    trace: Json = {
        "type": "heatmap",
        "name": "Lost, mL",
        "x": rounded(rpm, 1),
        "y": rounded(nm, 1),
        "z": rounded(grid, 2),
        "customdata": told.tolist(),
        "hoverongaps": False,
        "zmin": -reach,
        "zmax": reach,
        "colorscale": [[0.0, theme.series[2]], [0.5, theme.raised], [1.0, theme.series[1]]],
        "colorbar": colour_bar(theme, "Lost, mL", nticks=5, tickangle=0),
        "hovertemplate": "%{x:.0f} rpm, %{y:.0f} Nm<br>%{z:.1f} mL lost of %{customdata[1]} mL"
        "<br>%{customdata[0]} s there<extra></extra>",
    }
    layout = base_layout(
        theme,
        "score-cells",
        margin={"l": 52, "r": 20, "t": 52, "b": 48},
        xaxis=axis(theme, ENGINE_SPEED, showgrid=False, zeroline=False),
        yaxis=axis(theme, TORQUE, showgrid=False, zeroline=False),
    )
    return figure([trace], layout)
