"""Are innovations independent of each other, and how many independent ones are they worth?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray

PORTMANTEAU_LAGS = 10
FEWEST = PORTMANTEAU_LAGS + 5
COARSER_FROM_LAG = 8
COARSER_BY = 1.15


@dataclass(frozen=True, slots=True)
class Whiteness:
    """Correlation of a sequence with itself, in its own order.

    Attributes
    ----------
    lag1 : float
        Correlation of neighbours; 0 where the sequence is white.
    portmanteau : float
        Ljung and Box's statistic over ten lags by its degrees of freedom; about 1 where the sequence is white.
    independent : float
        How many independent samples tell the mean as well as these.
    independent_squares : float
        The same of the mean square: a Gaussian sequence's squares are correlated like its correlations squared.
    """

    lag1: float
    portmanteau: float
    independent: float
    independent_squares: float


def whiteness(values: FloatArray) -> Whiteness:
    """Measure how white a sequence is, apart from its mean.

    Correlations are summed up to the first lag at which they can't be told from zero; from the eighth lag on not
    every one is looked at.

    Parameters
    ----------
    values : array, shape (n,)
    """
    n = len(values)
    centred = np.ascontiguousarray(values, dtype=np.float64) - (np.mean(values) if n else 0.0)
    power = float(np.dot(centred, centred))
    if n < FEWEST or power == 0.0:
        return Whiteness(np.nan, np.nan, float(n), float(n))

    def correlation(lag: int) -> float:
        return float(np.dot(centred[:-lag], centred[lag:])) / power

    first = np.array([correlation(lag) for lag in range(1, PORTMANTEAU_LAGS + 1)])
    box = n * (n + 2.0) * float(np.sum(first**2 / (n - np.arange(1, PORTMANTEAU_LAGS + 1)))) / PORTMANTEAU_LAGS
    total = squares = 0.0
    before, lag, noise = 0, 1, 2.0 / np.sqrt(n)
    while lag < n // 4:
        own = float(first[lag - 1]) if lag <= PORTMANTEAU_LAGS else correlation(lag)
        if own < noise:
            break
        total, squares = total + own * (lag - before), squares + own**2 * (lag - before)
        before, lag = lag, lag + 1 if lag < COARSER_FROM_LAG else int(lag * COARSER_BY)
    return Whiteness(float(first[0]), box, n / (1.0 + 2.0 * total), n / (1.0 + 2.0 * squares))
