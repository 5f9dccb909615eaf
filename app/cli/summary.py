"""``summary.json``: what a call of ``process`` found, in totals and trip by trip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from app.exports.summary import mean_nis

VERDICTS = ("healthy", "doubtful", "failed")
ADDED_UP = ("events", "duration_s", "distance_m", "fuel_energy_j", "fuel_l", "operating_points")


def total_summary(
    trips: Sequence[Mapping[str, Any]], warnings: Sequence[str], timing_s: Mapping[str, float]
) -> dict[str, Any]:
    """Return the whole document.

    Parameters
    ----------
    trips : sequence of mappings
        `app.exports.summary.observation_summary` of each trip.
    warnings : sequence of str
        What concerns no single trip.
    timing_s : mapping of str to float
        Wall time of each stage.

    Returns
    -------
    dict
        Sums over the trips that know the figure (None where no trip does), the worst verdict, every warning, and the
        trips themselves.
    """
    return {
        **{name: known_sum([trip[name] for trip in trips]) for name in ADDED_UP},
        **{name: trips[0][name] for name in ("filter", "tuning", "smoothed")},
        "nis": mean_nis([(trip["events"], trip["nis"]) for trip in trips]),
        "verdict": max((trip["verdict"] for trip in trips), key=VERDICTS.index),
        "reasons": [reason for trip in trips for reason in trip["reasons"]],
        "warnings": [*warnings, *(warning for trip in trips for warning in trip["warnings"])],
        "timing_s": {**timing_s, "total": sum(timing_s.values())},
        "trips": list(trips),
    }


def known_sum(values: Sequence[float | None]) -> float | None:
    """Return the sum of the values that are known, or None when none is."""
    known = [value for value in values if value is not None]
    return sum(known) if known else None
