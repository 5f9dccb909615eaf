"""An observation in short, as JSON-able numbers and words."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from app.science.observer.result import Observation


def observation_summary(observation: Observation, *, points: int) -> dict[str, Any]:
    """Return what ``summary.json`` says of one trip; a number that is not known is None.

    Parameters
    ----------
    observation : Observation
    points : int
        Its operating points.
    """
    o = observation
    return {
        "events": o.events,
        "duration_s": o.duration_s,
        "distance_m": _known(o.distance_m),
        "fuel_energy_j": _known(o.fuel_energy_j),
        "fuel_l": _known(o.fuel_l),
        "operating_points": points,
        "filter": o.filter,
        "tuning": o.tuning,
        "smoothed": o.smoothed,
        "nis": mean_nis([(sensor.count - sensor.rejected, sensor.nis_mean) for sensor in o.sensors]),
        "sensors": {
            sensor.sensor: {
                "count": sensor.count,
                "rejected": sensor.rejected,
                "nis": _known(sensor.nis_mean),
                "within_two_sigma": _known(sensor.within_two_sigma),
                "within_one_sigma": _known(sensor.within_one_sigma),
                "nis_band": [_known(sensor.nis_low), _known(sensor.nis_high)],
                "lag1": _known(sensor.lag1),
                "portmanteau": _known(sensor.portmanteau),
                "bias": _known(sensor.bias),
                "recovered": sensor.recovered,
                "refusal_episodes": sensor.episode_count,
                "longest_refusal_s": sensor.longest_refusal_s,
            }
            for sensor in o.sensors
        },
        "verdict": o.verdict,
        "reasons": list(o.reasons),
        "warnings": list(o.warnings),
    }


def mean_nis(weighted: Sequence[tuple[int, float | None]]) -> float | None:
    """Return the mean of the normalised innovations squared, by how many measurements stand behind each; 1 is ideal.

    None where there are no measurements.
    """
    counted = [(count, nis) for count, nis in weighted if count and nis is not None and isfinite(nis)]
    total = sum(count for count, _ in counted)
    return sum(count * nis for count, nis in counted) / total if total else None


def _known(value: float) -> float | None:
    return value if isfinite(value) else None
