"""What a formula leaves over: each trusted cell minus the formula."""

from __future__ import annotations

from dataclasses import replace

from app.figures.fit_frame import FitFrame, residuals
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme, colour_bar, figure
from app.science.engine.fitting.family import Fitted, MapFits
from app.science.engine.raster import raster


def fit_residuals_figure(fits: MapFits, one: Fitted, frame: FitFrame, theme: Theme) -> Json:
    """Draw a formula's residuals in points of efficiency, in the same colours for all formulas of the frame."""
    left = residuals(fits.efficiency_map, one.formula)
    cells = raster(replace(fits.efficiency_map, efficiency=left))
    trace: Json = {
        "type": "heatmap",
        "name": "cell minus formula",
        "x": rounded(cells.rpm, 1),
        "y": rounded(cells.nm, 1),
        "z": rounded(cells.efficiency, 1),
        "hoverongaps": False,
        "zmin": -frame.residual,
        "zmax": frame.residual,
        "colorscale": [[0.0, theme.series[0]], [0.5, theme.line], [1.0, theme.series[1]]],
        "colorbar": colour_bar(theme, "Residual, points", nticks=5, tickangle=0),
        "hovertemplate": "%{z:+.1f} points<br>%{x:.0f} rpm, %{y:.0f} Nm<extra></extra>",
    }
    return figure([trace], frame.layout(theme, f"fit-left-{one.formula.target}"))
