"""The efficiency map's data: sums per cell, which add up over trips, and the trusted cells they give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class CellGrid:
    """Cells of the map (Sebesta 2010, 3.4: 50 rpm by 2 Nm) and when one is trusted.

    A cell covers ``[i · rpm, (i + 1) · rpm) × [j · nm, (j + 1) · nm)``; its centre is at ``(i + ½) · rpm`` and
    ``(j + ½) · nm``. A cell is trusted with at least ``min_count`` points whose standard deviation is at most
    ``max_sd`` (0.05: five points of efficiency). Where points are ``independent``, as seconds apart on a polled bus, it
    is the standard error of their mean that must be that small.
    """

    rpm: float = 50.0
    nm: float = 2.0
    min_count: int = 10
    max_sd: float = 0.05
    independent: bool = False

    def column(self, rpm: FloatArray) -> IntArray:
        """Index i of the cells at these engine speeds."""
        return np.floor(rpm / self.rpm).astype(np.int64)

    def row(self, nm: FloatArray) -> IntArray:
        """Index j of the cells at these torques."""
        return np.floor(nm / self.nm).astype(np.int64)

    def centre_rpm(self, column: IntArray) -> FloatArray:
        """Engine speed at the centres of these columns, rpm."""
        return np.asarray((column + 0.5) * self.rpm, dtype=np.float64)

    def centre_nm(self, row: IntArray) -> FloatArray:
        """Torque at the centres of these rows, Nm."""
        return np.asarray((row + 0.5) * self.nm, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class CellSums:
    """Sums of one or more trips, one entry per occupied cell, every array of shape (m,); sorted by (i, j).

    Sums are plain, so the map of several trips is the sum of the trips' sums, in any order.
    """

    i: IntArray
    j: IntArray
    n: IntArray
    efficiency_sum: FloatArray
    efficiency_squared_sum: FloatArray
    power_sum_w: FloatArray
    fuel_power_sum_w: FloatArray


@dataclass(frozen=True, slots=True)
class Idle:
    """The engine at idle.

    Attributes
    ----------
    rpm, rpm_sd : float
        Mean, and how far single moments are from it.
    fuel_power_w, fuel_power_sd_w : float
    litres_per_hour : float
    seconds : float
        How long it was seen.
    """

    rpm: float
    rpm_sd: float
    fuel_power_w: float
    fuel_power_sd_w: float
    litres_per_hour: float
    seconds: float


@dataclass(frozen=True, slots=True)
class EfficiencyMap:
    """Trusted and untrusted cells, every array of shape (m,).

    Attributes
    ----------
    grid : CellGrid
    rpm, nm : array
        Cell centres.
    n : integer array
        Operating points in the cell.
    efficiency : array
        Mean efficiency of the cell; NaN where the cell is not trusted.
    sd : array
        Standard deviation of the points in the cell; NaN below two points.
    bsfc_gpkwh : array
        Brake-specific fuel consumption, g/kWh; NaN where not trusted.
    full_load_rpm, full_load_nm : array, shape (k,)
        The most torque that the engine gave, by rising engine speed.
    full_load_sd : array, shape (k,), or None
        Standard deviation, Nm; NaN where nothing tells it. None in a map made elsewhere that doesn't say.
    full_load_reached : bool array, shape (k,), or None
        True where that is all the engine can give, False where it is a lower bound. None likewise.
    idle : Idle or None
        None where the trips don't tell.
    warnings : tuple of str
        What can't be true of the cells, and what to check.
    """

    grid: CellGrid
    rpm: FloatArray
    nm: FloatArray
    n: IntArray
    efficiency: FloatArray
    sd: FloatArray
    bsfc_gpkwh: FloatArray
    full_load_rpm: FloatArray
    full_load_nm: FloatArray
    full_load_sd: FloatArray | None = None
    full_load_reached: BoolArray | None = None
    idle: Idle | None = None
    warnings: tuple[str, ...] = ()
