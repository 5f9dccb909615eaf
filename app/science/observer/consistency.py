"""Does the filter deserve belief: innovations against their own predicted spread, and a verdict in words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.science.arrays import FloatArray
from app.science.observer.columns import PROPELLING_W
from app.science.observer.gears import NODE_SPACING_S
from app.science.observer.result import Innovations, SensorConsistency, Verdict

ENOUGH = 30
DOUBTFUL_NIS = 3.0
FAILED_NIS = 12.0
DOUBTFUL_REJECTED = 0.05
FAILED_REJECTED = 0.30
ENOUGH_PROPELLING_S = 20.0
DOUBTFUL_TOLD = 0.10
"""Share of the propelling time at which efficiency is known, below which the thrust is too vague. Trips with an
accelerometer have 0.85 and more, those with a receiver and wheel ticks alone 0.4, a table of speed, engine speed and
fuel rate has 0.005 at most."""


def consistency(innovations: Innovations) -> tuple[SensorConsistency, ...]:
    """Return one entry per sensor that gave measurements."""
    entries = []
    for number, name in enumerate(innovations.sensors):
        mine = innovations.sensor == number
        count = int(mine.sum())
        if count == 0:
            continue
        accepted = mine & (innovations.accepted > 0)
        normalised = innovations.innovation[accepted] / innovations.sd[accepted]
        used = len(normalised) > 0
        entries.append(
            SensorConsistency(
                sensor=name,
                count=count,
                rejected=count - int(accepted.sum()),
                nis_mean=float(np.mean(normalised**2)) if used else float("nan"),
                within_two_sigma=float(np.mean(np.abs(normalised) <= 2.0)) if used else float("nan"),
            )
        )
    return tuple(entries)


def verdict_of(
    sensors: tuple[SensorConsistency, ...], columns: Mapping[str, FloatArray]
) -> tuple[Verdict, tuple[str, ...]]:
    """Judge a run from its sensors' consistency; returns the verdict and its reasons in words."""
    failed: list[str] = []
    doubtful: list[str] = []
    for sensor in sensors:
        if sensor.count < ENOUGH:
            continue
        refused = sensor.rejected / sensor.count
        if refused > DOUBTFUL_REJECTED:
            text = f"{refused:.0%} of the {sensor.sensor} measurements contradict all others and were refused"
            (failed if refused > FAILED_REJECTED else doubtful).append(text)
        elif sensor.nis_mean > DOUBTFUL_NIS:
            text = (
                f"{sensor.sensor} measurements scatter {sensor.nis_mean**0.5:.1f} times as far from the prediction "
                "as the filter expects"
            )
            (failed if sensor.nis_mean > FAILED_NIS else doubtful).append(text)
    doubtful += vague_thrust(sensors, columns)
    if not np.isfinite(columns["speed_mps"]).all():
        failed.append("the speed is not known everywhere")
    if failed:
        return "failed", tuple(failed + doubtful)
    if doubtful:
        return "doubtful", tuple(doubtful)
    return "healthy", ("every sensor agrees with the others within its stated noise",)


def vague_thrust(sensors: tuple[SensorConsistency, ...], columns: Mapping[str, FloatArray]) -> list[str]:
    """Say so when thrust is known too roughly to tell the engine's efficiency while it propels the car.

    An engine that reports its torque tells its efficiency without the thrust, and without fuel there is none to tell.
    """
    if any(sensor.sensor == "engine_torque" for sensor in sensors):
        return []
    in_gear = (columns["gear"] > 0) | ~np.any(columns["gear"] > 0)
    propels = (columns["power_w"] > PROPELLING_W) & np.isfinite(columns["fuel_power_w"]) & in_gear
    told = np.isfinite(columns["efficiency"][propels])
    if len(told) * NODE_SPACING_S < ENOUGH_PROPELLING_S or told.mean() >= DOUBTFUL_TOLD:
        return []
    return [
        f"the thrust is known too roughly: the engine's efficiency can be told for only {told.mean():.0%} of the time "
        "it drove the car, because neither acceleration nor the engine's torque is measured, or not often enough"
    ]
