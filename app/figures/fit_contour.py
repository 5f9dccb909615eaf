"""A formula as contours: plain where the car was driven, faint beyond."""

from __future__ import annotations

from math import ceil

import numpy as np

from app.figures.fit_frame import FitFrame
from app.figures.map_limits import full_load_lines
from app.figures.numbers import rounded
from app.figures.theme import FONT, Json, Theme, colour_bar, figure
from app.science.arrays import FloatArray
from app.science.engine.fitting.cells import RADPS_PER_RPM
from app.science.engine.fitting.family import Fitted, MapFits
from app.science.engine.fitting.gaps import Gap
from app.science.engine.fitting.surface import cut_off

VEIL = 0.62


def fit_contour_figure(fits: MapFits, one: Fitted, frame: FitFrame, theme: Theme) -> Json:
    """Draw a formula's efficiency over engine speed and torque.

    Parameters
    ----------
    fits : MapFits
    one : Fitted
        Of these.
    frame : FitFrame
        Of the same.
    theme : Theme
    """
    grid = {"x": rounded(frame.rpm, 0), "y": rounded(frame.nm, 1)}
    z = 100.0 * _efficiency(fits, one, frame)
    scale = frame.scale
    traces: list[Json] = [
        {
            "type": "contour",
            "name": one.formula.terms.name,
            **grid,
            "z": rounded(np.where(np.abs(z) < 2.0 * scale.high, z, np.nan), 1),
            "contours": {
                "coloring": "heatmap",
                "showlabels": True,
                "start": scale.step * ceil(scale.low / scale.step),
                "end": scale.high,
                "size": 2.0 * scale.step,
                "labelfont": {"family": FONT, "size": 10, "color": theme.ink},
            },
            "line": {"color": theme.ink, "width": 0.6},
            "colorbar": colour_bar(theme, scale.title, nticks=4, tickangle=0),
            "hovertemplate": "%{z:.1f} %<br>%{x:.0f} rpm, %{y:.0f} Nm<extra></extra>",
        }
        | scale.colours("zmin", "zmax"),
        _veil(fits, frame, grid, theme),
    ]
    if len(fits.efficiency_map.full_load_rpm):
        traces += full_load_lines(fits.efficiency_map, theme)
    if one.peak is not None:
        peak = one.peak
        traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": "best",
                "x": [peak.rpm],
                "y": [peak.nm],
                "marker": {
                    "symbol": "star",
                    "size": 13,
                    "color": theme.highlight,
                    "line": {"color": theme.raised, "width": 1.5},
                },
                "hovertemplate": f"best: {100.0 * peak.efficiency:.1f} ± {100.0 * peak.sd:.1f} %<br>"
                "%{x:.0f} rpm, %{y:.0f} Nm<extra></extra>",
            }
        )
    layout = frame.layout(theme, f"fit-{one.formula.target}-{one.formula.terms.name}")
    if fits.request.remedy == "drive":
        layout["shapes"] = [_outline(gap, theme) for gap in fits.gaps]
    return figure(traces, layout)


def _efficiency(fits: MapFits, one: Fitted, frame: FitFrame) -> FloatArray:
    """Return η on the frame's grid, shape (rows, columns); NaN where it is cut off."""
    omega, nm = np.meshgrid(frame.rpm * RADPS_PER_RPM, frame.nm)
    if fits.request.remedy != "cut" or one.peak is None:
        return one.formula.efficiency(omega, nm)
    cut = cut_off(one.formula, one.peak, omega.ravel(), nm.ravel()).reshape(omega.shape)
    return np.where(cut > 0.0, cut, np.nan)


def _veil(fits: MapFits, frame: FitFrame, grid: Json, theme: Theme) -> Json:
    """Cover what was not driven with the background's colour, so that it is there but faint."""
    red, green, blue = (int(theme.raised[at : at + 2], 16) for at in (1, 3, 5))
    return {
        "type": "contour",  # a heatmap would lie below the contours, whatever the order
        "name": "beyond what was driven",
        **grid,
        "z": (~fits.area.holds(frame.rpm, frame.nm)).T.astype(int).tolist(),
        "zmin": 0,
        "zmax": 1,
        "contours": {"coloring": "heatmap", "start": 0.5, "end": 0.5, "size": 1},
        "line": {"color": theme.ink, "width": 1, "dash": "dot"},
        "colorscale": [[0, f"rgba({red},{green},{blue},0)"], [1, f"rgba({red},{green},{blue},{VEIL})"]],
        "showscale": False,
        "hoverinfo": "skip",
    }


def _outline(gap: Gap, theme: Theme) -> Json:
    (x0, x1), (y0, y1) = gap.rpm_range, gap.nm_range
    return {
        "type": "rect",
        "x0": x0,
        "x1": x1,
        "y0": y0,
        "y1": y1,
        "line": {"color": theme.highlight, "width": 1.5, "dash": "dash"},
        "label": {"text": "drive here", "font": {"size": 11, "color": theme.ink}},
    }
