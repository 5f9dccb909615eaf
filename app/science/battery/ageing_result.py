"""What became of a battery and what will, as numbers and as the document that figures and pages are made of."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.health import LabTest, Points
from app.science.battery.life import SIGMAS, Remaining
from app.science.battery.trend import Trend

YEAR_DAYS = 365.25
CYCLES = 100.0
DRAWN = 121
FAR_SPANS = 1.5
"""A band is drawn at most so many observed spans beyond the last point."""


@dataclass(frozen=True, slots=True)
class Aged:
    """One value's history.

    Attributes
    ----------
    points : Points
        Independent of each other.
    trend : Trend or None
        Over days; None where there are too few points.
    by_cycles : Trend or None
        Over equivalent full cycles.
    remaining : Remaining or None
        In days.
    remaining_cycles : Remaining or None
        In equivalent full cycles.
    """

    points: Points
    trend: Trend | None
    by_cycles: Trend | None
    remaining: Remaining | None
    remaining_cycles: Remaining | None

    def document(self, whole: float) -> dict[str, Any]:
        """Return it as JSON; shares are of ``whole``."""
        trend, points = self.trend, self.points
        return {
            "points": {
                "at_days": points.at.tolist(),
                "value": points.value.tolist(),
                "sd": points.sd.tolist(),
            },
            "trend": None if trend is None else _trend_document(trend, whole),
            "slope_share_per_100_cycles": _scaled(self.by_cycles, CYCLES / whole, sd=False),
            "slope_share_per_100_cycles_sd": _scaled(self.by_cycles, CYCLES / whole, sd=True),
            "band": None if trend is None else _band(trend, self.remaining),
            "remaining": None if self.remaining is None else self.remaining.document("days"),
            "remaining_cycles": None if self.remaining_cycles is None else self.remaining_cycles.document("cycles"),
        }


@dataclass(frozen=True, slots=True)
class Compared:
    """A laboratory's test beside what the estimates' trend says of its time.

    Attributes
    ----------
    test : LabTest
    estimated_ah, estimated_sd : float or None
        None where there is no trend.
    sigmas : float or None
        Test less estimate, over both standard deviations together.
    """

    test: LabTest
    estimated_ah: float | None
    estimated_sd: float | None
    sigmas: float | None

    def document(self) -> dict[str, Any]:
        """Return it as JSON."""
        return {
            "at_days": self.test.at,
            "capacity_ah": self.test.capacity_ah,
            "capacity_ah_sd": self.test.sd_ah,
            "estimated_ah": self.estimated_ah,
            "estimated_ah_sd": self.estimated_sd,
            "difference_ah": None if self.estimated_ah is None else self.test.capacity_ah - self.estimated_ah,
            "sigmas": self.sigmas,
        }


@dataclass(frozen=True, slots=True)
class Ageing:
    """A battery's history and prospects.

    Attributes
    ----------
    rated_ah : float
        What shares of the capacity are of.
    first_ohm : float
        What shares of the resistance are of: what it was at first.
    threshold : float
        Share of the rated capacity at which the battery counts as spent.
    capacity, resistance : Aged
    cycles : float or None
        Equivalent full cycles that were seen.
    tests : tuple of Compared
    used_tests : bool
        Whether the tests took part in the trend.
    warnings : tuple of str
    """

    rated_ah: float
    first_ohm: float
    threshold: float
    capacity: Aged
    resistance: Aged
    cycles: float | None
    tests: tuple[Compared, ...]
    used_tests: bool
    warnings: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """Return everything as JSON: days as the points had them, values of one cell, None where nothing is known."""
        document: dict[str, Any] = _finite(
            {
                "rated_capacity_ah": self.rated_ah,
                "first_resistance_ohm": self.first_ohm,
                "threshold": self.threshold,
                "capacity": self.capacity.document(self.rated_ah),
                "resistance": self.resistance.document(self.first_ohm),
                "equivalent_full_cycles": self.cycles,
                "tests": [one.document() for one in self.tests],
                "used_tests": self.used_tests,
                "warnings": list(self.warnings),
            }
        )
        return document


def _trend_document(trend: Trend, whole: float) -> dict[str, Any]:
    last = np.array([trend.x0 + trend.span])
    value, sd = float(trend.at(last)[0]), float(trend.sd(last)[0])
    return {
        "shape": trend.likeliest.shape,
        "shape_probability": float(trend.weights[0]),
        "from_days": trend.x0,
        "to_days": float(last[0]),
        "value": value,
        "value_sd": sd,
        "share": value / whole,
        "share_sd": sd / whole,
        "slope_share_per_year": _scaled(trend, YEAR_DAYS / whole, sd=False),
        "slope_share_per_year_sd": _scaled(trend, YEAR_DAYS / whole, sd=True),
        "scatter": trend.likeliest.scatter,
        "neighbours_correlation": trend.likeliest.together,
    }


def _scaled(trend: Trend | None, factor: float, *, sd: bool) -> float | None:
    """Return the slope at the trend's last point, or its standard deviation, times a factor."""
    if trend is None:
        return None
    last = np.array([trend.x0 + trend.span])
    return factor * float((trend.slope_sd if sd else trend.slope)(last)[0])


def _band(trend: Trend, left: Remaining | None) -> dict[str, list[float]]:
    ahead = FAR_SPANS * trend.span
    if left is not None and left.ahead:
        ahead = min(ahead, 1.1 * left.ahead)
    x: FloatArray = trend.x0 + np.linspace(0.0, trend.span + ahead, DRAWN)
    value, sd = trend.at(x), trend.sd(x)
    return {
        "at_days": x.tolist(),
        "value": value.tolist(),
        "sd": sd.tolist(),
        "low": (value - SIGMAS * sd).tolist(),
        "high": (value + SIGMAS * sd).tolist(),
    }


def _finite(value: Any) -> Any:
    """Return a document without numbers that JSON doesn't have."""
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not isfinite(value) else value
