"""What one trip says about a car's calibration, small enough to keep for every trip, and several trips together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.science.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Estimate:
    """Numbers with their covariance.

    Attributes
    ----------
    value : tuple of float, length n
    covariance : tuple of tuples of float, n by n
    """

    value: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]

    @classmethod
    def of(cls, value: FloatArray, covariance: FloatArray) -> Estimate:
        """Make one of arrays of shape (n,) and (n, n)."""
        return cls(tuple(np.atleast_1d(value).tolist()), tuple(map(tuple, np.atleast_2d(covariance).tolist())))

    @property
    def sd(self) -> FloatArray:
        """Standard deviations, shape (n,)."""
        return np.asarray(np.sqrt(np.diag(np.array(self.covariance))))


@dataclass(frozen=True, slots=True)
class TripEvidence:
    """What one trip says; plain numbers that several trips can be combined from, whatever the car's file says by then.

    Attributes
    ----------
    estimates : mapping of str to Estimate
        ``forward``, ``right``: the car's axes as the raw accelerometer sees a unit of acceleration (3 each);
        ``gravity``: its mean reading, m/s² (3); ``metres_per_tick``; ``speed_scale``: true speed over measured speed;
        ``gps_latency``, s; ``clock_skew``, millionths that the logger's clock runs faster than UTC; ``bias``: the
        observer's, m/s² (3).
    numbers : mapping of str to float
        Totals: ``duration_s``, ``distance_m``, and of injector pulses ``pulse_count``, ``pulse_s`` and
        ``shortest_pulse_s``.
    missing : mapping of str to str
        Per name of `app.science.calibration.proposal.NAMES`, why this trip says nothing of it, in a sentence.
    """

    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    numbers: Mapping[str, float] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the same as plain dicts, lists and numbers, ready for JSON."""
        return {
            "estimates": {
                name: {"value": list(estimate.value), "covariance": [list(row) for row in estimate.covariance]}
                for name, estimate in self.estimates.items()
            },
            "numbers": dict(self.numbers),
            "missing": dict(self.missing),
        }

    @classmethod
    def from_dict(cls, plain: Mapping[str, Any]) -> TripEvidence:
        """Return what `to_dict` was made from."""
        estimates = {
            name: Estimate(tuple(entry["value"]), tuple(tuple(row) for row in entry["covariance"]))
            for name, entry in plain["estimates"].items()
        }
        return cls(estimates, dict(plain["numbers"]), dict(plain["missing"]))


@dataclass(frozen=True, slots=True)
class Combined:
    """Estimates of several trips as one.

    Attributes
    ----------
    value : array, shape (n,)
    covariance : array, shape (n, n)
        Widened by the disagreement between the trips where they disagree more than they should.
    trips : int
    """

    value: FloatArray
    covariance: FloatArray
    trips: int

    @property
    def sd(self) -> FloatArray:
        """Standard deviations, shape (n,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


def combine(evidences: Iterable[TripEvidence], name: str) -> Combined | None:
    """Combine the trips' estimates of one name, each by its information; None where no trip has one."""
    found = [evidence.estimates[name] for evidence in evidences if name in evidence.estimates]
    if not found:
        return None
    values = np.array([estimate.value for estimate in found])
    informations = np.array([np.linalg.inv(np.array(estimate.covariance)) for estimate in found])
    covariance = np.linalg.inv(informations.sum(axis=0))
    value = covariance @ np.einsum("tij,tj->i", informations, values)
    apart = values - value
    freedom = values.size - values.shape[1]
    chi_squared = float(np.einsum("ti,tij,tj->", apart, informations, apart))
    widening = max(chi_squared / freedom, 1.0) if freedom else 1.0
    return Combined(value, covariance * widening, len(found))
