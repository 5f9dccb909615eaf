"""A straight or a root-shaped line through points that fade, with what may be believed of it beyond the last one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.arrays import FloatArray

Shape = Literal["linear", "square root"]
SHAPES: tuple[Shape, Shape] = ("linear", "square root")

ROUNDS = 30
HUBER = 2.0
"""Residuals beyond so many standard deviations count less and less."""

WANDER = 0.4
"""Standard deviation of what the slope may change by, as a share of itself, over a span as long as the observed one.
Cells bend: a knee, another use, another climate. Nothing in the points before tells that."""

CHANCE = 1.5
"""Correlations of n unrelated numbers have a standard deviation of 1/√n; one beyond so many counts."""

LINE_FIRST = 3.0
"""Odds for a line against a root of time before the points have spoken: Ah lost per day is what one fears first."""


@dataclass(frozen=True, slots=True)
class Line:
    """Value = level + slope · shape(x), fitted through points with standard deviations.

    Attributes
    ----------
    shape : str
        ``linear`` in x, or ``square root`` of x since the first point.
    x0, span : float
        First point, and from there to the last.
    coefficients : ndarray (2,)
    covariance : ndarray (2, 2)
        Scaled up by what the points scatter more than they say, and by what they go together.
    scatter : float
        √ of χ² per degree of freedom, robust; 1 where the points scatter as they say.
    together : float
        Correlation of neighbouring residuals, 0 where none is seen.
    deviation : float
        Standard deviation of what the value itself does beside the trend, 0 where scatter is not seen to last longer
        than a point: cells rest and recover.
    shared_sd : float
        What all points may be off by together.
    cost : float
        χ² after Huber.
    """

    shape: Shape
    x0: float
    span: float
    coefficients: FloatArray
    covariance: FloatArray
    scatter: float
    together: float
    deviation: float
    shared_sd: float
    cost: float

    def at(self, x: FloatArray) -> FloatArray:
        """Return the line at each x, (m,)."""
        return np.asarray(_basis(x, self.x0, self.shape) @ self.coefficients)

    def variance(self, x: FloatArray) -> FloatArray:
        """Return the variance of the value at each x, (m,); beyond the last point with the slope's (`WANDER`)."""
        basis = _basis(x, self.x0, self.shape)
        ahead = np.maximum(x - self.x0 - self.span, 0.0)
        steepness = abs(float(self.slope(np.array([self.x0 + self.span]))[0]))
        wander = WANDER**2 * steepness**2 * ahead**3 / (3.0 * self.span)
        level = self.deviation**2 + self.shared_sd**2
        return np.asarray(np.einsum("ij,jk,ik->i", basis, self.covariance, basis) + wander + level)

    def slope(self, x: FloatArray) -> FloatArray:
        """Return the change per unit of x, (m,)."""
        return np.asarray(self.coefficients[1] * self._steepness(x))

    def slope_variance(self, x: FloatArray) -> FloatArray:
        """Return the variance of `slope`, (m,)."""
        return np.asarray(self.covariance[1, 1] * self._steepness(x) ** 2)

    def _steepness(self, x: FloatArray) -> FloatArray:
        if self.shape == "linear":
            return np.ones_like(x)
        return np.asarray(0.5 / np.sqrt(np.maximum(x - self.x0, 0.01 * self.span)))


@dataclass(frozen=True, slots=True)
class Trend:
    """Lines through the same points, each believed as much as the points speak for it.

    Attributes
    ----------
    lines : tuple of Line
        The likeliest first.
    weights : ndarray (lines,)
        Their probabilities.
    """

    lines: tuple[Line, ...]
    weights: FloatArray

    @property
    def likeliest(self) -> Line:
        """The line that the points speak for most."""
        return self.lines[0]

    @property
    def x0(self) -> float:
        """First point."""
        return self.lines[0].x0

    @property
    def span(self) -> float:
        """From the first point to the last."""
        return self.lines[0].span

    def at(self, x: FloatArray) -> FloatArray:
        """Return the expected value at each x, (m,)."""
        return np.asarray(self.weights @ [line.at(x) for line in self.lines])

    def sd(self, x: FloatArray) -> FloatArray:
        """Return its standard deviation, (m,), with what the lines differ by."""
        return self._sd([line.at(x) for line in self.lines], [line.variance(x) for line in self.lines])

    def slope(self, x: FloatArray) -> FloatArray:
        """Return the expected change per unit of x, (m,)."""
        return np.asarray(self.weights @ [line.slope(x) for line in self.lines])

    def slope_sd(self, x: FloatArray) -> FloatArray:
        """Return the standard deviation of `slope`, (m,)."""
        return self._sd([line.slope(x) for line in self.lines], [line.slope_variance(x) for line in self.lines])

    def _sd(self, means: list[FloatArray], variances: list[FloatArray]) -> FloatArray:
        apart = np.array(means) - self.weights @ means
        return np.asarray(np.sqrt(self.weights @ (np.array(variances) + apart**2)))


def fit_trend(x: FloatArray, y: FloatArray, sd: FloatArray, shared_sd: float = 0.0) -> Trend:
    """Fit a line and a root through points, and weigh them by what the points say.

    Parameters
    ----------
    x, y, sd : ndarray (n,)
        Three points at least, ascending in x, not all at one; standard deviations of y that are independent of each
        other.
    shared_sd : float
        What all of y may be off by together: it widens the band and leaves the slope.

    Returns
    -------
    Trend
        By Huber's weights, so that a single wild point bends nothing.
    """
    line, root = (_fit(x, y, sd, shared_sd, shape) for shape in SHAPES)
    thinned = (1.0 - line.together) / (1.0 + line.together) / min(line.scatter, root.scatter) ** 2
    odds = LINE_FIRST * np.exp(np.clip(0.5 * thinned * (root.cost - line.cost), -500.0, 500.0))
    weights = np.array([odds, 1.0]) / (odds + 1.0)
    return Trend((line, root), weights) if odds >= 1.0 else Trend((root, line), weights[::-1].copy())


def _fit(x: FloatArray, y: FloatArray, sd: FloatArray, shared_sd: float, shape: Shape) -> Line:
    x0, span = float(x[0]), float(x[-1] - x[0])
    basis, weights = _basis(x, x0, shape) / sd[:, None], np.ones(len(x))
    for _ in range(ROUNDS):
        rooted = np.sqrt(weights)
        coefficients = np.asarray(np.linalg.lstsq(basis * rooted[:, None], y / sd * rooted, rcond=None)[0], np.float64)
        residual = y / sd - basis @ coefficients
        usual = max(1.0, 1.4826 * float(np.median(np.abs(residual))) * np.sqrt(len(x) / (len(x) - 2.0)))
        weights = np.minimum(1.0, HUBER * usual / np.maximum(np.abs(residual), 1e-12))
    scatter = max(1.0, float(np.sqrt(np.sum(weights * residual**2) / max(np.sum(weights) - 2.0, 1.0))))
    together = _together(residual)
    size = np.sqrt(np.sum(weights[:, None] * basis**2, axis=0))
    informed = np.linalg.pinv((basis * weights[:, None]).T @ basis / np.outer(size, size)) / np.outer(size, size)
    covariance = informed * scatter**2 * (1.0 + together) / (1.0 - together)
    deviation = float(np.median(sd)) * float(np.sqrt(scatter**2 - 1.0)) if together > 0.0 else 0.0
    cost = float(np.sum(weights * (2.0 - weights) * residual**2))
    return Line(shape, x0, span, coefficients, covariance, scatter, together, deviation, shared_sd, cost)


def _together(residual: FloatArray) -> float:
    """Return the correlation of neighbouring residuals where it is more than chance usually makes."""
    n = len(residual)
    power = float(np.sum(residual**2))
    if n < 6 or power <= 0.0:
        return 0.0
    lag_one = float(np.sum(residual[1:] * residual[:-1])) / power
    return min(lag_one, 0.9) if lag_one > CHANCE / np.sqrt(n) else 0.0


def _basis(x: FloatArray, x0: float, shape: Shape) -> FloatArray:
    since = np.asarray(x) - x0
    return np.column_stack([np.ones_like(since), since if shape == "linear" else np.sqrt(np.maximum(since, 0.0))])
