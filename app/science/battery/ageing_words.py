"""What is to be known beside a battery's trends, in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from app.science.battery.ageing_result import Aged, Ageing
from app.science.battery.life import SIGMAS
from app.science.battery.trend import Trend

MUCH_SCATTER = 1.5
ODD_SIGMAS = 3.0
FAR_SPANS = 1.0
"""A prospect further ahead than the history reaches back is an extrapolation that is warned of."""


def warned(ageing: Ageing) -> Ageing:
    """Return the result with its warnings."""
    words = (*_history(ageing), *_spread(ageing.capacity, "capacity"), *_spread(ageing.resistance, "resistance"))
    return replace(ageing, warnings=(*words, *_prospect(ageing), *_tests(ageing)))


def _history(ageing: Ageing) -> Iterator[str]:
    known = len(ageing.capacity.points.at)
    if ageing.capacity.trend is None:
        have = "no estimate says" if known == 0 else "one estimate says" if known == 1 else f"{known} estimates say"
        yield (
            f"There is no trend yet: {have} something new about the capacity; three over more than a day are needed."
        )
    elif (slope := _sigmas(ageing.capacity.trend)) > SIGMAS:
        yield (
            f"The capacity seems to grow, by {slope:.1f} standard deviations: cells don't. Estimates that have not "
            "settled yet, or a temperature that changed, look like that."
        )


def _sigmas(trend: Trend) -> float:
    last = np.array([trend.x0 + trend.span])
    return float((trend.slope(last) / trend.slope_sd(last))[0])


def _spread(aged: Aged, what: str) -> Iterator[str]:
    if aged.trend is None:
        return
    trend = aged.trend.likeliest
    if trend.scatter > MUCH_SCATTER:
        yield (
            f"The estimates of the {what} scatter {trend.scatter:.1f} times as much as their standard deviations say; "
            "the trend's are widened by that."
        )
    if trend.together > 0.0:
        yield (
            f"Neighbouring estimates of the {what} lie off the trend together (correlation {trend.together:.2f}); it "
            "is taken as less certain for that."
        )


def _prospect(ageing: Ageing) -> Iterator[str]:
    left, trend = ageing.capacity.remaining, ageing.capacity.trend
    if left is None or trend is None:
        return
    if left.verdict == "unknown":
        yield "How long the battery lasts can't be told yet: the trend's band is too wide."
    elif left.ahead is not None and left.ahead > FAR_SPANS * trend.span:
        yield (
            f"The end of life lies {left.ahead / trend.span:.1f} times as far ahead as the history reaches back; a "
            "cell that bends before will not last as long."
        )


def _tests(ageing: Ageing) -> Iterator[str]:
    for one in ageing.tests:
        if one.sigmas is None or one.estimated_ah is None or abs(one.sigmas) <= ODD_SIGMAS:
            continue
        difference = one.test.capacity_ah - one.estimated_ah
        sign = "more" if difference > 0.0 else "less"
        yield (
            f"A laboratory's test says {abs(difference):.3g} Ah {sign} than the estimates, {abs(one.sigmas):.1f} "
            "standard deviations: was it made at another temperature or current, or is the rated curve not the cell's?"
        )
