"""A scored trip beside its best drive along the road."""

from __future__ import annotations

import numpy as np

from app.figures.drive_panels import KMH, Line, Panel
from app.figures.drive_stack import panels_figure
from app.figures.theme import LIGHT, Json, Theme, empty_figure
from app.science.arrays import FloatArray, IntArray
from app.science.eco.result import Along
from app.science.optimal.problem import RADPS_PER_RPM

NOTHING = "No section of this trip could be scored."
DRIVEN, BEST = "As driven", "Best drive"
PER_100KM = 100.0


def along_figure(along: Along, *, theme: Theme = LIGHT) -> Json:
    """Draw speed, gear, engine speed and torque of both drives over the distance, and what was lost where.

    Parameters
    ----------
    along : Along
        Between two sections the lines have a gap.
    theme : Theme
    """
    if not len(along.distance_m):
        return empty_figure(theme, "score-along", NOTHING)
    cut = np.flatnonzero(np.diff(along.section)) + 1
    km = _with_gaps(along.distance_m / 1000.0, cut, kept=True)

    def line(name: str, values: FloatArray) -> Line:
        return Line(name, km, _with_gaps(values, cut))

    limit = Line("Limit", km, _with_gaps(KMH * along.limit_mps, cut), "limit")
    panels = (
        _both("Speed", "km/h", 1, line(DRIVEN, KMH * along.speed_mps), line(BEST, KMH * along.best_speed_mps), limit),
        _both("Gear", "", 0, line(DRIVEN, along.gear), line(BEST, along.best_gear), stepped=True),
        _both(
            "Engine speed",
            "rpm",
            0,
            line(DRIVEN, along.engine_speed_radps / RADPS_PER_RPM),
            line(BEST, along.best_engine_speed_radps / RADPS_PER_RPM),
        ),
        _both("Torque", "Nm", 1, line(DRIVEN, along.torque_nm), line(BEST, along.best_torque_nm)),
        Panel("Lost here", "L/100 km", 2, (line("Lost", PER_100KM * along.lost_lpkm),)),
    )
    return panels_figure(panels, theme, "score-along", "Distance, km")


def _both(
    label: str, unit: str, decimals: int, driven: Line, best: Line, *limits: Line, stepped: bool = False
) -> Panel:
    other = Line(best.name, best.x, best.y, "other")
    return Panel(label, unit, decimals, (*limits, driven, other), stepped=stepped)


def _with_gaps(values: FloatArray, cut: IntArray, *, kept: bool = False) -> FloatArray:
    """Put a row between sections: not a number, or, for the axis, the place where the next section begins."""
    return np.insert(values, cut, values[cut] if kept else np.nan)
