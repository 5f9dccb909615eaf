"""Which of many differences are more than chance."""

from __future__ import annotations

from math import erfc, sqrt

import numpy as np

from app.science.arrays import BoolArray, FloatArray

FALSE_SHARE = 0.05


def two_sided_chance(normalised: FloatArray, freedom: FloatArray | None = None) -> FloatArray:
    """Return how likely chance alone gives as large a value, of either sign.

    Parameters
    ----------
    normalised : array, shape (n,)
        Differences over their standard deviations.
    freedom : array, shape (n,), optional
        Degrees of freedom that the standard deviations were estimated with. Student's distribution is brought to the
        normal one by Wallace's formula (1959), which is within 1e-3 of it from three degrees on.
    """
    size = np.abs(np.asarray(normalised, dtype=np.float64))
    if freedom is not None:
        size = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * np.sqrt(freedom * np.log1p(size**2 / freedom))
    return np.array([erfc(one / sqrt(2.0)) for one in size.tolist()])


def told_apart(chance: FloatArray, false_share: float = FALSE_SHARE) -> BoolArray:
    """Choose those of many questions that are answered, by the rule of Benjamini and Hochberg (1995).

    Of the chosen, ``false_share`` at most are chance in the mean.

    Parameters
    ----------
    chance : array, shape (n,)
        Probability of each by chance alone.
    false_share : float
    """
    order = np.argsort(chance)
    allowed = false_share * np.arange(1, len(chance) + 1) / max(len(chance), 1)
    passed = np.flatnonzero(chance[order] <= allowed)
    chosen = np.zeros(len(chance), np.bool_)
    if len(passed):
        chosen[order[: passed[-1] + 1]] = True
    return chosen
