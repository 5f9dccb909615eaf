"""``summary.json``: what a call of ``process`` found, in totals and trip by trip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from app.science.observer.result import Observation

TripSummary = dict[str, Any]
VERDICTS = ("healthy", "doubtful", "failed")


def trip_summary(observation: Observation, *, file: str, states: str, points: int) -> TripSummary:
    """Return one trip's entry.

    Parameters
    ----------
    observation : Observation
    file, states : str
        Name of the file it came from and of the file its states went to.
    points : int
        Its operating points.
    """
    o = observation
    return {
        "file": file,
        "states": states,
        "events": o.events,
        "duration_s": o.duration_s,
        "distance_m": o.distance_m,
        "fuel_energy_j": o.fuel_energy_j,
        "fuel_l": o.fuel_l,
        "operating_points": points,
        "filter": o.filter,
        "tuning": o.tuning,
        "smoothed": o.smoothed,
        "nis": mean_nis([(sensor.count - sensor.rejected, sensor.nis_mean) for sensor in o.sensors]),
        "sensors": {
            sensor.sensor: {
                "count": sensor.count,
                "rejected": sensor.rejected,
                "nis": sensor.nis_mean,
                "within_two_sigma": sensor.within_two_sigma,
            }
            for sensor in o.sensors
        },
        "verdict": o.verdict,
        "reasons": list(o.reasons),
        "warnings": list(o.warnings),
    }


def total_summary(
    trips: Sequence[TripSummary], warnings: Sequence[str], timing_s: Mapping[str, float]
) -> dict[str, Any]:
    """Return the whole document: sums over the trips, the worst verdict, every warning, and the trips themselves."""
    sums = ("events", "duration_s", "distance_m", "fuel_energy_j", "fuel_l", "operating_points")
    totals: dict[str, Any] = {name: sum(trip[name] for trip in trips) for name in sums}
    return totals | {
        "filter": trips[0]["filter"],
        "tuning": trips[0]["tuning"],
        "smoothed": trips[0]["smoothed"],
        "nis": mean_nis([(trip["events"], trip["nis"]) for trip in trips]),
        "verdict": max((trip["verdict"] for trip in trips), key=VERDICTS.index),
        "reasons": [reason for trip in trips for reason in trip["reasons"]],
        "warnings": [*warnings, *(warning for trip in trips for warning in trip["warnings"])],
        "timing_s": dict(timing_s) | {"total": sum(timing_s.values())},
        "trips": list(trips),
    }


def mean_nis(weighted: Sequence[tuple[int, float]]) -> float:
    """Return the mean of the normalised innovations squared, by how many measurements stand behind each; 1 is ideal."""
    counted = [(count, nis) for count, nis in weighted if count and nis == nis]
    total = sum(count for count, _ in counted)
    return sum(count * nis for count, nis in counted) / total if total else float("nan")
