"""The ball on the wheel: the locus on which the control changes, lines of equal time, and the way taken."""

from __future__ import annotations

import numpy as np

from app.figures.drive_documents import DrawnDrive
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure
from app.science.arrays import FloatArray

NOTHING = "Only the ball on the wheel has a synthesis to draw."
DASHES = {"u_min": "solid", "u_max": "dash"}


def synthesis_figure(drive: DrawnDrive, theme: Theme) -> Json:
    """Draw the state plane with what to do everywhere in it (Sebesta 2010, App. G).

    Parameters
    ----------
    drive : DrawnDrive
    theme : Theme
    """
    drawn = drive.answer.get("synthesis")
    if not drawn:
        return empty_figure(theme, "drive-synthesis", NOTHING)
    traces = [
        _line(
            np.array(one["x1"]),
            np.array(one["x2"]),
            f"{one['time_s']:.3g} s to rest",
            {"color": theme.quiet, "width": 1},
        )
        for one in drawn["isochrones"]
    ]
    locus = drawn["locus"]
    ink = {"color": theme.ink, "width": 2, "dash": "dot"}
    traces.append(_line(np.array(locus["x1"]), np.array(locus["x2"]), "control changes here", ink))
    x1, x2, u = (drive.column(name) for name in ("x1", "x2", "u"))
    for value, name in ((u.min(), "u_min"), (u.max(), "u_max")):
        on = np.where(u == value, 1.0, np.nan)
        colour = {"color": theme.highlight, "width": 3, "dash": DASHES[name]}
        traces.append(_line(x1 * on, x2 * on, f"the way, u = {value:.4g}".replace("-", "−"), colour))
    traces.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": "start",
            "x": rounded(x1[:1], 4),
            "y": rounded(x2[:1], 4),
            "marker": {"size": 11, "color": theme.highlight, "line": {"color": theme.raised, "width": 1.5}},
            "hovertemplate": "start: x₁ %{x:.4g}, x₂ %{y:.4g}<extra></extra>",
        }
    )
    layout = base_layout(
        theme,
        "drive-synthesis",
        margin={"l": 52, "r": 12, "t": 12, "b": 100},
        xaxis=axis(theme, "x₁"),
        yaxis=axis(theme, "x₂"),
    )
    return figure(traces, layout)


def _line(x: FloatArray, y: FloatArray, name: str, line: Json) -> Json:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": rounded(x, 4),
        "y": rounded(y, 4),
        "line": line,
        "hovertemplate": f"{name}<br>x₁ %{{x:.4g}}, x₂ %{{y:.4g}}<extra></extra>",
    }
