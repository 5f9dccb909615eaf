"""Lines and points that lie over an efficiency map."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from app.figures.decimate import even_indices
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme
from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.operating_line import optimal_operating_line
from app.science.engine.points import OperatingPoints
from app.science.engine.reading import Peak

RADPS_PER_RPM = pi / 30.0
POWERS_KW = (2, 5, 10, 15, 20, 30, 40, 50, 60, 80, 100, 125, 150, 200, 250, 300, 400)
TRIP_POINTS = 600


@dataclass(frozen=True, slots=True)
class PowerLines:
    """A trace, and the annotations that say at the right end which power each line is."""

    trace: Json
    labels: list[Json]


def power_lines(rpm_range: tuple[float, float], top_nm: float, theme: Theme) -> PowerLines:
    """Draw lines of constant power through the plot."""
    rpm = np.linspace(*rpm_range, 40)
    x: list[float | None] = []
    y: list[float | None] = []
    labels: list[Json] = []
    for power in POWERS_KW:
        torque = 1000.0 * power / (rpm * RADPS_PER_RPM)
        inside = torque <= top_nm
        if inside.sum() < 8:
            continue
        x += [*rounded(rpm[inside], 0), None]
        y += [*rounded(torque[inside], 1), None]
        labels.append(
            {
                "text": f"{power} kW",
                "x": rpm_range[1],
                "y": round(float(torque[-1]), 1),
                "xanchor": "left",
                "showarrow": False,
                "font": {"size": 11, "color": theme.quiet},
            }
        )
    trace: Json = {
        "type": "scatter",
        "mode": "lines",
        "name": "constant power",
        "x": x,
        "y": y,
        "line": {"color": theme.quiet, "width": 1, "dash": "dot"},
        "hoverinfo": "skip",
    }
    return PowerLines(trace, labels)


def operating_line(efficiency_map: EfficiencyMap, theme: Theme) -> list[Json]:
    """Draw the most efficient engine speed and torque for each power, on a casing that sets it off from the map."""
    line = optimal_operating_line(efficiency_map)
    place = {"type": "scatter", "mode": "lines", "x": rounded(line.rpm, 1), "y": rounded(line.nm, 1)}
    text = [[p, e] for p, e in zip(rounded(line.power_w / 1000.0, 1), rounded(100.0 * line.efficiency, 1), strict=True)]
    return [
        place
        | {
            "line": {"color": theme.raised, "width": 5},
            "hoverinfo": "skip",
            "showlegend": False,
            "legendgroup": "best",
        },
        place
        | {
            "name": "most efficient per power",
            "legendgroup": "best",
            "customdata": text,
            "line": {"color": theme.highlight, "width": 2.5},
            "hovertemplate": "%{customdata[0]:.1f} kW: %{customdata[1]:.1f} % at best,<br>"
            "%{x:.0f} rpm and %{y:.0f} Nm<extra></extra>",
        },
    ]


def best_point(best: Peak, label: str, theme: Theme) -> Json:
    """Mark the most efficient operating point."""
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"best: {label} at {best.rpm:.0f} rpm, {best.nm:.0f} Nm",
        "x": [round(best.rpm, 1)],
        "y": [round(best.nm, 1)],
        "marker": {
            "symbol": "star",
            "size": 16,
            "color": theme.highlight,
            "line": {"color": theme.raised, "width": 1.5},
        },
        "hovertemplate": f"best: {label}<br>%{{x:.0f}} rpm, %{{y:.0f}} Nm<extra></extra>",
    }


def trip_points(points: OperatingPoints, theme: Theme) -> Json:
    """Draw where the last trip ran the engine."""
    kept = even_indices(len(points), TRIP_POINTS)
    efficiency: FloatArray = 100.0 * points.efficiency[kept]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "last trip",
        "x": rounded(points.engine_speed_rpm[kept], 0),
        "y": rounded(points.torque_nm[kept], 1),
        "customdata": rounded(efficiency, 1),
        "marker": {"size": 3, "color": theme.ink, "opacity": 0.35},
        "hovertemplate": "last trip: %{customdata:.1f} %<br>%{x:.0f} rpm, %{y:.1f} Nm<extra></extra>",
    }
