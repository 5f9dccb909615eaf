"""The car's efficiency map as a surface."""

from __future__ import annotations

import numpy as np

from app.figures.map_scale import ENGINE_SPEED, NOTHING, TORQUE, Shown, map_meta, scale_of, shown_values
from app.figures.numbers import rounded
from app.figures.theme import LIGHT, Json, Theme, base_layout, colour_bar, empty_figure, figure
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.raster import raster
from app.science.engine.reading import peak

SCATTERED = "The known cells don't touch yet, so there is no surface;<br>the map from above shows them."


def surface_figure(efficiency_map: EfficiencyMap, *, shown: Shown = "efficiency", theme: Theme = LIGHT) -> Json:
    """Draw the smoothed cells as a surface over engine speed and torque.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    shown : {"efficiency", "bsfc"}
    theme : Theme
    """
    if peak(efficiency_map) is None:
        return empty_figure(theme, "surface", NOTHING)
    cells = raster(efficiency_map)
    smooth = shown_values(cells, shown).smooth
    known = np.isfinite(smooth)
    if not (known[1:, 1:] & known[1:, :-1] & known[:-1, 1:] & known[:-1, :-1]).any():
        return empty_figure(theme, "surface", SCATTERED)
    scale = scale_of(shown, smooth)
    trace: Json = {
        "type": "surface",
        "name": scale.name,
        "x": rounded(cells.rpm, 1),
        "y": rounded(cells.nm, 1),
        "z": rounded(smooth, scale.decimals),
        **scale.colours("cmin", "cmax"),
        "colorbar": colour_bar(theme, scale.title),
        "lighting": {"ambient": 0.85, "diffuse": 0.35, "specular": 0.05, "roughness": 0.9},
        "contours": {"z": {"show": True, "usecolormap": True, "project": {"z": False}, "width": 1}},
        "hovertemplate": f"%{{z:.{scale.decimals}f}} {scale.unit}<br>%{{x:.0f}} rpm, %{{y:.0f}} Nm<extra></extra>",
    }
    layout = base_layout(
        theme,
        f"surface-{shown}",
        margin={"l": 0, "r": 12, "t": 52, "b": 0},
        scene={
            "xaxis": _wall(theme, ENGINE_SPEED),
            "yaxis": _wall(theme, TORQUE),
            "zaxis": _wall(theme, scale.title),
            "aspectmode": "manual",
            "aspectratio": {"x": 1.1, "y": 1.0, "z": 0.7},
            "camera": {"eye": {"x": -1.6, "y": -1.9, "z": 1.1}, "center": {"x": 0, "y": 0, "z": -0.18}},
        },
        meta=map_meta(efficiency_map),
    )
    return figure([trace], layout)


def _wall(theme: Theme, title: str) -> Json:
    """Return an axis of the scene: quiet lines, no wall behind them."""
    return {
        "title": {"text": title, "font": {"size": 12, "color": theme.quiet}},
        "tickfont": {"size": 11, "color": theme.quiet},
        "gridcolor": theme.line,
        "zerolinecolor": theme.line,
        "linecolor": theme.line,
        "showbackground": False,
    }
