"""What the figures of formulas side by side have in common, so that they can be compared at a glance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.figures.map_scale import ENGINE_SPEED, TORQUE, MapScale, scale_of
from app.figures.theme import Json, Theme, axis, base_layout
from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.fitting.cells import RADPS_PER_RPM
from app.science.engine.fitting.family import MapFits
from app.science.engine.fitting.polynomial import Formula

COLUMNS, ROWS = 57, 45
BEYOND = 0.12
RESIDUAL_SHARE = 97.0
WIDEST_RESIDUAL = 10.0


@dataclass(frozen=True, slots=True)
class FitFrame:
    """Axes and colours of all formulas through one map.

    Attributes
    ----------
    rpm : array, shape (columns,)
    nm : array, shape (rows,)
        Where the formulas are drawn: a little beyond what was driven.
    scale : MapScale
        Of efficiency, from the cells.
    residual : float
        Points of efficiency at which the colours of the residuals end, from all formulas.
    """

    rpm: FloatArray
    nm: FloatArray
    scale: MapScale
    residual: float

    def layout(self, theme: Theme, revision: str) -> Json:
        """Return the layout of a small figure over engine speed and torque."""
        return base_layout(
            theme,
            revision,
            margin={"l": 46, "r": 10, "t": 46, "b": 40},
            showlegend=False,
            xaxis=axis(theme, ENGINE_SPEED, range=_ends(self.rpm), showgrid=False, nticks=6),
            yaxis=axis(theme, TORQUE, range=_ends(self.nm), showgrid=False, zeroline=False),
        )


def fit_frame(fits: MapFits) -> FitFrame:
    """Return the frame of all formulas that were asked for."""
    area, whole = fits.area, fits.efficiency_map
    beyond = BEYOND * (area.rpm[-1] - area.rpm[0])
    top = 1.05 * max(float(area.nm[-1]), float(whole.full_load_nm.max()) if len(whole.full_load_nm) else 0.0)
    known = np.isfinite(whole.efficiency)
    left = [_finite(residuals(whole, one.formula)[known]) for one in fits.fits]
    limit = max(np.percentile(np.abs(one), RESIDUAL_SHARE) for one in left)
    return FitFrame(
        rpm=np.linspace(max(float(area.rpm[0] - beyond), 0.0), float(area.rpm[-1] + beyond), COLUMNS),
        nm=np.linspace(0.0, top, ROWS),
        scale=scale_of("efficiency", 100.0 * whole.efficiency),
        residual=float(np.clip(np.ceil(limit), 1.0, WIDEST_RESIDUAL)),
    )


def residuals(whole: EfficiencyMap, formula: Formula) -> FloatArray:
    """Return cells minus formula, points of efficiency, shape of the map's cells."""
    return np.asarray(100.0 * (whole.efficiency - formula.efficiency(whole.rpm * RADPS_PER_RPM, whole.nm)))


def _finite(values: FloatArray) -> FloatArray:
    found = values[np.isfinite(values)]
    return found if len(found) else np.zeros(1)


def _ends(values: FloatArray) -> list[float]:
    return [round(float(values[0]), 1), round(float(values[-1]), 1)]
