"""How well causes, each over its own trips, explain what is different from a car's usual."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.health.evidence import TERMS
from app.science.health.usual import COUNT, Score, Usual

TYPICAL_CHANGE = (20.0, 100.0, 20.0, 6.0)
"""Size of a change worth a word, in %, kg, %, %: it weighs causes against each other, not against chance."""
ROADS_N_PER_KG = 0.0022
"""Force by which kinds of roads differ that the usual doesn't explain: 1–2 N on a virtual car of 919 kg."""


@dataclass(frozen=True, slots=True)
class Cause:
    """A quantity that is off its usual from one trip up to, not including, another; trips by their place."""

    quantity: int
    start: int
    stop: int


@dataclass(frozen=True, slots=True)
class Explanation:
    """Causes taken together, arrays of shape (m,).

    Attributes
    ----------
    change : array
        Of each cause, in the quantity's unit.
    scatter_sd : array
        As the trips' own differences make it uncertain.
    sd : array
        The same with `ROADS_N_PER_KG`, which no number of trips takes away.
    """

    change: FloatArray
    scatter_sd: FloatArray
    sd: FloatArray


class Told:
    """What trips say, summed from the first one on, so that any stretch of trips costs the same."""

    def __init__(self, scores: Sequence[Score], usual: Usual, mass_kg: float) -> None:
        self.trips = len(scores)
        self._usual_information = usual.information
        self.mass_kg = mass_kg
        self._usual = _sums([one.usual for one in scores], (TERMS,))
        self._information = _sums([one.usual_information for one in scores], (TERMS, TERMS))
        self._change = _sums([one.change for one in scores], (COUNT,))
        self._change_information = _sums([one.change_information for one in scores], (COUNT, COUNT))
        self._cross = _sums([one.cross for one in scores], (COUNT, TERMS))
        self._effect_n = _sums([one.effect_n for one in scores], (COUNT,))

    def explain(self, causes: Sequence[Cause]) -> Explanation:
        """Estimate causes together; that the usual itself is an estimate from the baseline is counted.

        Parameters
        ----------
        causes : sequence of Cause
            At least one.
        """
        score, information = self._of(causes)
        covariance = np.linalg.inv(information)
        return self._explanation(causes, covariance @ score, np.sqrt(np.diag(covariance)))

    def each(self, start: int, stop: int) -> Explanation:
        """Estimate each quantity over trips as if it alone had changed; arrays of shape (4,)."""
        causes = [Cause(quantity, start, stop) for quantity in range(COUNT)]
        score, information = self._of(causes)
        return self._explanation(causes, score / np.diag(information), 1.0 / np.sqrt(np.diag(information)))

    def _explanation(self, causes: Sequence[Cause], change: FloatArray, scatter_sd: FloatArray) -> Explanation:
        effect_n = [
            (self._effect_n[one.stop] - self._effect_n[one.start])[one.quantity] / (one.stop - one.start)
            for one in causes
        ]
        return Explanation(change, scatter_sd, np.hypot(scatter_sd, ROADS_N_PER_KG * self.mass_kg / np.array(effect_n)))

    def _of(self, causes: Sequence[Cause]) -> tuple[FloatArray, FloatArray]:
        """Return score and information of causes, the usual's coefficients integrated out."""
        first, last = min(one.start for one in causes), max(one.stop for one in causes)
        curvature = self._usual_information + self._information[last] - self._information[first]
        cross = np.array([(self._cross[one.stop] - self._cross[one.start])[one.quantity] for one in causes])
        score = np.array([(self._change[one.stop] - self._change[one.start])[one.quantity] for one in causes])
        shared = np.array([[self._shared(one, other) for other in causes] for one in causes])
        solved = np.linalg.solve(curvature, cross.T).T
        return score - solved @ (self._usual[last] - self._usual[first]), shared - solved @ cross.T

    def _shared(self, one: Cause, other: Cause) -> float:
        start, stop = max(one.start, other.start), min(one.stop, other.stop)
        if stop <= start:
            return 0.0
        sums = self._change_information
        return float(sums[stop, one.quantity, other.quantity] - sums[start, one.quantity, other.quantity])


def chances(changes: FloatArray, sds: FloatArray) -> FloatArray:
    """Return the probability of each quantity to be the one cause, shape (4,), from its change and its sd.

    All are equally probable beforehand, with changes of about `TYPICAL_CHANGE`.
    """
    evidence = (changes / sds) ** 2 - np.log1p((np.array(TYPICAL_CHANGE) / sds) ** 2)
    weight = np.exp(0.5 * (evidence - np.max(evidence)))
    return np.asarray(weight / weight.sum())


def _sums(parts: list[FloatArray], shape: tuple[int, ...]) -> FloatArray:
    sums = np.zeros((len(parts) + 1, *shape))
    np.cumsum(np.array(parts).reshape(-1, *shape), axis=0, out=sums[1:])
    return sums
