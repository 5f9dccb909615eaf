"""How a car's map lies beside a dynamometer's or a manufacturer's table (Sebesta 2010, 3.5)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.reading import peak
from app.science.engine.reference import FEWEST_POINTS, ReferenceMap

BAND_RPM, BAND_NM = 500.0, 20.0
"""Neighbouring cells err alike: the scale's uncertainty comes from leaving out one such band after the other."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """How a car's map lies beside a reference.

    Attributes
    ----------
    cells : int
        Trusted cells inside the reference.
    scale, scale_sd : float
        Factor from the reference to the map, and its standard deviation by how the factor differs over the map. What
        raises or lowers the whole map alike, as a wrong mass would, is not in it.
    correlation : float
        Of the two shapes, from −1 to 1.
    peak_rpm, peak_nm : float
        From the reference's best point to the map's, both smoothed over the same cells.
    rmse, rmse_scaled : float
        Root mean square difference, as it is and after taking the scale out.
    """

    cells: int
    scale: float
    scale_sd: float
    correlation: float
    peak_rpm: float
    peak_nm: float
    rmse: float
    rmse_scaled: float


def agreement(efficiency_map: EfficiencyMap, reference: ReferenceMap) -> Agreement | None:
    """Compare a map with a reference over the trusted cells inside it; None when they hardly overlap."""
    m = efficiency_map
    expected = reference.at(m.rpm, m.nm)
    both = np.isfinite(m.efficiency) & np.isfinite(expected)
    if np.count_nonzero(both) < FEWEST_POINTS:
        return None
    own, other = m.efficiency[both], expected[both]
    scale = _scale(own, other)
    mine, theirs = (peak(replace(m, efficiency=np.where(both, e, np.nan))) for e in (m.efficiency, expected))
    if mine is None or theirs is None:
        return None
    return Agreement(
        cells=len(own),
        scale=scale,
        scale_sd=_scale_sd(m.rpm[both], m.nm[both], own, other),
        correlation=float(np.corrcoef(own, other)[0, 1]),
        peak_rpm=mine.rpm - theirs.rpm,
        peak_nm=mine.nm - theirs.nm,
        rmse=float(np.sqrt(np.mean((own - other) ** 2))),
        rmse_scaled=float(np.sqrt(np.mean((own - scale * other) ** 2))),
    )


def _scale(own: FloatArray, other: FloatArray) -> float:
    return float(own @ other / (other @ other))


def _scale_sd(rpm: FloatArray, nm: FloatArray, own: FloatArray, other: FloatArray) -> float:
    """Return the scale's standard deviation: the larger one of bands of engine speed and of torque."""
    products, squares = own * other, other**2
    return max(_jackknife(rpm // BAND_RPM, products, squares), _jackknife(nm // BAND_NM, products, squares))


def _jackknife(band: FloatArray, products: FloatArray, squares: FloatArray) -> float:
    """Return the standard deviation of a ratio of sums by leaving out one band after the other; 0 for a single one."""
    _, which = np.unique(band, return_inverse=True)
    above, below = np.bincount(which, products), np.bincount(which, squares)
    count = len(above)
    if count < 2:
        return 0.0
    without = (above.sum() - above) / (below.sum() - below)
    return float(np.sqrt((count - 1.0) / count * np.sum((without - without.mean()) ** 2)))
