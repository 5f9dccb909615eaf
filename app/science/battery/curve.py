"""The open-circuit voltage over the state of charge: a polynomial, or a table with monotone interpolation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray, IntArray

__all__ = ["CurvePieces", "OpenCircuit", "slope_at", "soc_at", "voltage_at"]

SAMPLES = 4001
"""Points at which a curve is looked at as a whole."""


class CurvePieces(NamedTuple):
    """A curve as kernels take it: polynomials in the distance from where each piece starts.

    Outside the first start and the last, the curve goes on as a straight line.
    """

    starts: FloatArray
    """(n + 1,): state of charge where each piece starts, and where the last one ends."""

    coefficients: FloatArray
    """(n, d + 1): ascending, in volts over state of charge less the piece's start."""


@dataclass(frozen=True, slots=True)
class OpenCircuit:
    """Open-circuit voltage of one cell (MAUTC-2010-02, eq. 56), as it was given and as pieces.

    Attributes
    ----------
    coefficients : tuple of float
        Of a polynomial in the state of charge, ascending; empty for a table.
    points : tuple of (float, float)
        Rows of state of charge and volts, ascending in both; empty for a polynomial.
    soc_range : tuple of float
        Where the curve is known, as shares of the capacity.
    pieces : CurvePieces
    """

    coefficients: tuple[float, ...] = ()
    points: tuple[tuple[float, float], ...] = ()
    soc_range: tuple[float, float] = (0.0, 1.0)
    pieces: CurvePieces = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        if bool(self.coefficients) == bool(self.points):
            raise ValueError("a curve is a polynomial or a table")
        if self.points:
            table = np.array(self.points, dtype=np.float64)
            object.__setattr__(self, "soc_range", (float(table[0, 0]), float(table[-1, 0])))
            object.__setattr__(self, "pieces", _monotone(table[:, 0], table[:, 1]))
        else:
            shifted = np.polynomial.Polynomial(self.coefficients)(np.polynomial.Polynomial([self.soc_range[0], 1.0]))
            object.__setattr__(self, "pieces", CurvePieces(np.array(self.soc_range), np.atleast_2d(shifted.coef)))

    def document(self) -> list[float] | list[list[float]]:
        """Return the curve as configurations hold it: coefficients or rows."""
        return [list(point) for point in self.points] if self.points else list(self.coefficients)

    def voltages(self) -> tuple[float, float]:
        """Return the lowest and the highest voltage inside the known range."""
        volts = voltage_at(self.pieces, np.linspace(*self.soc_range, SAMPLES))
        return float(volts.min()), float(volts.max())

    def falls(self) -> tuple[float, float] | None:
        """Return the first stretch of state of charge over which the curve falls; None when it rises throughout."""
        soc = np.linspace(*self.soc_range, SAMPLES)
        falling = np.flatnonzero(np.diff(voltage_at(self.pieces, soc)) < 0.0)
        if len(falling) == 0:
            return None
        jumps = np.flatnonzero(np.diff(falling) > 1)
        last = falling[jumps[0]] if len(jumps) else falling[-1]
        return float(soc[falling[0]]), float(soc[last + 1])


def voltage_at(pieces: CurvePieces, soc: FloatArray) -> FloatArray:
    """Return the open-circuit voltage, volts, at each state of charge, which may lie outside the known range."""
    piece, within, beyond = _places(pieces, soc)
    at = np.zeros_like(within)
    for coefficient in pieces.coefficients.T[::-1]:
        at = at * within + coefficient[piece]
    return np.asarray(at + beyond * _slope(pieces, piece, within))


def slope_at(pieces: CurvePieces, soc: FloatArray) -> FloatArray:
    """Return the slope of the open-circuit voltage, volts per whole charge (MAUTC-2010-02, eq. 63)."""
    piece, within, _ = _places(pieces, soc)
    return _slope(pieces, piece, within)


def soc_at(curve: OpenCircuit, volts: FloatArray) -> FloatArray:
    """Return the state of charge at each open-circuit voltage; at voltages outside the curve its nearest end.

    Where the curve falls for a stretch, the answer is the one of its smallest rising cover.
    """
    soc = np.linspace(*curve.soc_range, SAMPLES)
    return np.interp(volts, np.maximum.accumulate(voltage_at(curve.pieces, soc)), soc)


def _places(pieces: CurvePieces, soc: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    inside = np.clip(soc, pieces.starts[0], pieces.starts[-1])
    piece = np.searchsorted(pieces.starts, inside, side="right") - 1
    piece = np.clip(piece, 0, len(pieces.coefficients) - 1).astype(np.int64)
    return piece, inside - pieces.starts[piece], np.asarray(soc) - inside


def _slope(pieces: CurvePieces, piece: IntArray, within: FloatArray) -> FloatArray:
    slope = np.zeros_like(within)
    for power in range(pieces.coefficients.shape[1] - 1, 0, -1):
        slope = slope * within + power * pieces.coefficients[piece, power]
    return slope


def _monotone(x: FloatArray, y: FloatArray) -> CurvePieces:
    """Return the cubic pieces of Fritsch and Butland (1984), which never overshoot; as SciPy's PCHIP makes them.

    They are made here because the web server, which shows curves, has no room for SciPy.
    """
    width, rise = np.diff(x), np.diff(y) / np.diff(x)
    slope = np.zeros_like(y)
    if len(x) == 2:
        slope[:] = rise[0]
    else:
        before, after = rise[:-1], rise[1:]
        weights = 2.0 * width[1:] + width[:-1], width[1:] + 2.0 * width[:-1]
        same = before * after > 0.0
        mean = np.divide(weights[0], before, where=same, out=np.ones_like(before))
        mean += np.divide(weights[1], after, where=same, out=np.zeros_like(after))
        slope[1:-1] = np.where(same, (weights[0] + weights[1]) / mean, 0.0)
        slope[0] = _end_slope(width[0], width[1], rise[0], rise[1])
        slope[-1] = _end_slope(width[-1], width[-2], rise[-1], rise[-2])
    second = (3.0 * rise - 2.0 * slope[:-1] - slope[1:]) / width
    third = (slope[:-1] + slope[1:] - 2.0 * rise) / width**2
    return CurvePieces(x.copy(), np.column_stack([y[:-1], slope[:-1], second, third]))


def _end_slope(near: float, far: float, rise: float, next_rise: float) -> float:
    slope = ((2.0 * near + far) * rise - near * next_rise) / (near + far)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope
