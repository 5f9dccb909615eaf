"""How long a trend takes to reach a limit, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from app.science.battery.trend import Trend

Verdict = Literal["reached", "expected", "at the earliest", "not in sight", "unknown"]

SIGMAS = 2.0
FARTHEST_SPANS = 10.0
"""Nothing is said beyond so many times the observed span."""
STEPS = 4000
LEAST_SHARE = 0.5
"""Where the low edge of an interval lies within this share of the observed span, and nothing else is known, the band is
too wide to say anything."""


@dataclass(frozen=True, slots=True)
class Remaining:
    """From the last point on until a limit is reached, in the trend's x.

    Attributes
    ----------
    verdict : str
        ``reached``: the trend is there already. ``expected``: trend and both edges of its band get there. ``at the
        earliest``: the band's near edge does, the far one not within the horizon. ``not in sight``: not even the near
        edge does. ``unknown``: the band is too wide to tell.
    limit : float
        The value to be reached.
    ahead, low, high : float or None
        When the trend gets there, and the edges of its two-sigma band; None where they don't within the horizon.
    horizon : float
        How far was looked.
    """

    verdict: Verdict
    limit: float
    ahead: float | None
    low: float | None
    high: float | None
    horizon: float

    def document(self, unit: str) -> dict[str, Any]:
        """Return the result as JSON, with the unit of x at the end of each name."""
        return {
            "verdict": self.verdict,
            "limit": self.limit,
            f"remaining_{unit}": self.ahead,
            f"remaining_low_{unit}": self.low,
            f"remaining_high_{unit}": self.high,
            f"horizon_{unit}": self.horizon,
        }


def remaining(trend: Trend, limit: float, *, falling: bool) -> Remaining:
    """Return when a trend, and its band, reach a limit from above (``falling``) or from below.

    Parameters
    ----------
    trend : Trend
    limit : float
    falling : bool
        Whether the value ages downwards, as a capacity does.
    """
    horizon = FARTHEST_SPANS * trend.span
    ahead = horizon * np.linspace(0.0, 1.0, STEPS + 1) ** 2  # finer where it is near
    x = trend.x0 + trend.span + ahead
    sign = 1.0 if falling else -1.0
    left, room = sign * (trend.at(x) - limit), SIGMAS * trend.sd(x)
    middle, low, high = (_first(ahead, one) for one in (left, left - room, left + room))
    if middle == 0.0:
        return Remaining("reached", limit, 0.0, 0.0, high, horizon)
    if low is None:
        return Remaining("not in sight", limit, middle, None, None, horizon)
    if middle is not None and high is not None:
        return Remaining("expected", limit, middle, low, high, horizon)
    if low < LEAST_SHARE * trend.span and middle is None:
        return Remaining("unknown", limit, None, low, None, horizon)
    return Remaining("at the earliest", limit, middle, low, None, horizon)


def _first(ahead: np.ndarray[Any, Any], left: np.ndarray[Any, Any]) -> float | None:
    """Return where a distance first is used up, between the steps that enclose it."""
    over = np.flatnonzero(left <= 0.0)
    if len(over) == 0:
        return None
    at = int(over[0])
    if at == 0:
        return 0.0
    share = left[at - 1] / (left[at - 1] - left[at])
    return float(ahead[at - 1] + share * (ahead[at] - ahead[at - 1]))
