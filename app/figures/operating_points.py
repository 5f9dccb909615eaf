"""The operating points of one trip."""

from __future__ import annotations

import numpy as np

from app.figures.decimate import even_indices
from app.figures.numbers import rounded, thousands
from app.figures.theme import EFFICIENCY_SCALE, LIGHT, Json, Theme, axis, base_layout, colour_bar, empty_figure, figure
from app.science.engine.points import OperatingPoints

MOST_POINTS = 3000
NOTHING = "The engine never propelled the car while its fuel and torque were known."


def operating_points_figure(points: OperatingPoints, *, theme: Theme = LIGHT) -> Json:
    """Draw torque over engine speed, coloured by efficiency.

    Parameters
    ----------
    points : OperatingPoints
    theme : Theme
    """
    if not len(points):
        return empty_figure(theme, "points", NOTHING)
    kept = even_indices(len(points), MOST_POINTS)
    efficiency = 100.0 * points.efficiency[kept]
    low, high = np.percentile(100.0 * points.efficiency, [2.0, 98.0])
    deviation = 100.0 * points.efficiency_sd[kept]
    trace: Json = {
        "type": "scatter",
        "mode": "markers",
        "name": "operating points",
        "x": rounded(points.engine_speed_rpm[kept], 0),
        "y": rounded(points.torque_nm[kept], 1),
        "customdata": [list(row) for row in zip(rounded(deviation, 1), rounded(points.t_s[kept], 1), strict=True)],
        "marker": {
            "size": 4,
            "line": {"width": 0.5, "color": theme.quiet},
            "color": rounded(efficiency, 1),
            "colorscale": EFFICIENCY_SCALE,
            "cmin": round(float(low), 1),
            "cmax": round(float(max(high, low + 1.0)), 1),
            "colorbar": colour_bar(theme, "Efficiency, %"),
        },
        "hovertemplate": "%{marker.color:.1f} % ± %{customdata[0]:.1f} points<br>%{x:.0f} rpm, %{y:.1f} Nm<br>"
        "%{customdata[1]:.1f} s after the start<extra></extra>",
    }
    badge = f"showing {thousands(len(kept))} of {thousands(len(points))}" if len(kept) < len(points) else ""
    layout = base_layout(
        theme,
        "points",
        showlegend=False,
        margin={"l": 52, "r": 12, "t": 52, "b": 44},
        xaxis=axis(theme, "Engine speed, rpm"),
        yaxis=axis(theme, "Torque, Nm", rangemode="tozero"),
        meta={"badge": badge, "shown": len(kept), "total": len(points), "torque_source": points.torque_source},
    )
    return figure([trace], layout)
