"""A run of the observer judged, with its reasons in words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.science.arrays import FloatArray
from app.science.observer.columns import PROPELLING_W
from app.science.observer.gears import NODE_SPACING_S
from app.science.observer.result import SensorConsistency, Verdict
from app.science.observer.sensor_words import sensor_words
from app.science.observer.wheel_scale import WheelScale

ENOUGH = 30
DOUBTFUL_NIS = 3.0
FAILED_NIS = 12.0
DOUBTFUL_REJECTED = 0.05
FAILED_REJECTED = 0.30
DOUBTFUL_BIAS = 0.5
FAILED_BIAS = 2.0
CERTAIN = 5.0
"""A bias or a scale counts only where it is so many times its own standard deviation."""
DOUBTFUL_SCALE = 0.01
FAILED_SCALE = 0.10
ENOUGH_PROPELLING_S = 20.0
DOUBTFUL_TOLD = 0.10
"""Share of the propelling time at which efficiency is known, below which the thrust is too vague. Trips with an
accelerometer have 0.85 and more, those with a receiver and wheel ticks alone 0.4, a table of speed, engine speed and
fuel rate has 0.005 at most."""
DOUBTFUL_PITCH_SD_RAD = 0.0045
"""A slope not known to a quarter of a degree leaves a tenth of a cruising car's thrust open."""
TELL_THE_SLOPE = frozenset({"gps_altitude", "dem_altitude", "pitch"})
HEALTHY = ("every sensor agrees with the others within its stated noise",)


def verdict_of(
    sensors: tuple[SensorConsistency, ...], columns: Mapping[str, FloatArray], wheels: WheelScale | None = None
) -> tuple[Verdict, tuple[str, ...]]:
    """Judge a run.

    Parameters
    ----------
    sensors : tuple of SensorConsistency
    columns : mapping of str to array
        Of the observation.
    wheels : WheelScale, optional
        How far the positions moved for each metre of the wheels' ticks.

    Returns
    -------
    verdict : {"healthy", "doubtful", "failed"}
    reasons : tuple of str
        The graver ones first.
    """
    failed: list[str] = []
    doubtful: list[str] = []
    for text, grave in _contradictions(wheels, sensors):
        (failed if grave else doubtful).append(text)
    doubtful += vague_thrust(sensors, columns)
    if not np.isfinite(columns["speed_mps"]).all():
        failed.append("the speed is not known everywhere")
    if failed:
        return "failed", tuple(failed + doubtful)
    if doubtful:
        return "doubtful", tuple(doubtful)
    return "healthy", HEALTHY


def _contradictions(wheels: WheelScale | None, sensors: tuple[SensorConsistency, ...]) -> list[tuple[str, bool]]:
    """Return what contradicts what, and whether that is grave."""
    found = [] if wheels is None else wrong_wheels(wheels)
    for sensor in sensors:
        if sensor.count < ENOUGH:
            continue
        name = sensor_words(sensor.sensor)
        refused = sensor.rejected / sensor.count
        if refused > DOUBTFUL_REJECTED:
            text = f"{name}: {refused:.0%} of the measurements contradict all others and were refused"
            if sensor.longest_refusal_s >= 1.0:
                text += f", the longest time {sensor.longest_refusal_s:.0f} s on end"
            found.append((text, refused > FAILED_REJECTED))
        elif sensor.nis_mean > DOUBTFUL_NIS:
            text = (
                f"{name}: the measurements scatter {sensor.nis_mean**0.5:.1f} times as far from the prediction "
                "as the filter expects"
            )
            found.append((text, sensor.nis_mean > FAILED_NIS))
        elif abs(sensor.bias) > max(DOUBTFUL_BIAS, CERTAIN * sensor.bias_sd):
            side = "above" if sensor.bias > 0 else "below"
            text = (
                f"{name}: the measurements lie {side} the prediction throughout, by {abs(sensor.bias):.1f} standard "
                "deviations on average: look for a wrong scale or offset"
            )
            found.append((text, abs(sensor.bias) > FAILED_BIAS))
    return found


def wrong_wheels(wheels: WheelScale) -> list[tuple[str, bool]]:
    """Say so when the positions move farther than the wheels, or less far, and whether that is grave."""
    off = wheels.scale - 1.0
    if abs(off) <= max(DOUBTFUL_SCALE, CERTAIN * wheels.sd):
        return []
    text = (
        f"Wheels: the positions move {abs(off):.1%} {'farther' if off > 0 else 'less far'} than the ticks say "
        f"(± {2.0 * wheels.sd:.1%}): the metres per tick in the car's file are too {'small' if off > 0 else 'large'}"
    )
    return [(text, abs(off) > FAILED_SCALE)]


def vague_thrust(sensors: tuple[SensorConsistency, ...], columns: Mapping[str, FloatArray]) -> list[str]:
    """Say so when thrust is known too roughly to tell the engine's efficiency while it propels the car.

    An engine that reports its torque tells its efficiency without the thrust, and without fuel there is none to tell.
    """
    if any(sensor.sensor == "engine_torque" for sensor in sensors):
        return []
    in_gear = (columns["gear"] > 0) | ~np.any(columns["gear"] > 0)
    propels = (columns["power_w"] > PROPELLING_W) & np.isfinite(columns["fuel_power_w"]) & in_gear
    told = np.isfinite(columns["efficiency"][propels])
    if len(told) * NODE_SPACING_S < ENOUGH_PROPELLING_S:
        return []
    if told.mean() < DOUBTFUL_TOLD:
        return [
            f"the thrust is known too roughly: the engine's efficiency can be told for only {told.mean():.0%} of the "
            "time it drove the car, because neither acceleration nor the engine's torque is measured, or not often "
            "enough"
        ]
    pitch_sd = float(np.median(columns["pitch_rad_sd"][propels]))
    if pitch_sd <= DOUBTFUL_PITCH_SD_RAD or any(sensor.sensor in TELL_THE_SLOPE for sensor in sensors):
        return []
    return [
        f"the slope of the road is known to ± {np.degrees(2.0 * pitch_sd):.1f}° only, because nothing measures height: "
        "thrust and efficiency may be off throughout"
    ]
