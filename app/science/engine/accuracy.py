"""How far a map is from a known truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap


@dataclass(frozen=True, slots=True)
class MapError:
    """Difference between a map and the true efficiency over its trusted cells, as fractions of 1.

    Attributes
    ----------
    cells : int
        Trusted cells compared.
    rmse : float
        Every cell counts the same.
    rmse_weighted : float
        Every operating point counts the same.
    bias : float
        Mean of map minus truth.
    worst : float
        Largest absolute difference.
    """

    cells: int
    rmse: float
    rmse_weighted: float
    bias: float
    worst: float


def map_error(
    efficiency_map: EfficiencyMap, true_efficiency: Callable[[FloatArray, FloatArray], FloatArray]
) -> MapError:
    """Compare the trusted cells with the truth at their centres.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    true_efficiency : callable
        Takes engine speed in rpm and torque in Nm, arrays of shape (m,), and returns efficiency. Cells at which it
        is NaN are left out.

    Returns
    -------
    MapError
        NaN in every figure when no cell could be compared.
    """
    difference = efficiency_map.efficiency - true_efficiency(efficiency_map.rpm, efficiency_map.nm)
    compared = np.isfinite(difference)
    difference, weight = difference[compared], efficiency_map.n[compared]
    if not len(difference):
        return MapError(0, np.nan, np.nan, np.nan, np.nan)
    return MapError(
        cells=len(difference),
        rmse=float(np.sqrt(np.mean(difference**2))),
        rmse_weighted=float(np.sqrt(np.average(difference**2, weights=weight))),
        bias=float(difference.mean()),
        worst=float(np.abs(difference).max()),
    )
