"""What a driver is told: a few sentences with litres, the largest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.accelerations import shifts_up_rpm
from app.science.eco.losses import Drive, joule_price
from app.science.eco.result import Loss, Standing
from app.science.eco.ride import Ride
from app.science.eco.road import travelled_m
from app.science.eco.sections import Compared
from app.science.eco.tally import Scale

KMH = 3.6
WORTH_L = 0.005
WORTH_PERCENT = 0.5
BRAKINGS = 3
APART_S = 3.0
LEAST_FALL_MPS = 2.0
BEFORE_M = 400.0
SAME_RPM = 150.0


@dataclass(frozen=True, slots=True)
class Braking:
    """Brakes used once: where, from and to which speeds, and what it cost beyond the best drive there, J."""

    at_m: float
    from_mps: float
    to_mps: float
    cost_j: float


def advice(compared: Sequence[Compared], parts: Sequence[Loss], standing: Standing, scale: Scale) -> tuple[str, ...]:
    """Return what would have saved most; only what is worth five millilitres and half a percent."""
    found = [
        (loss.litres, words)
        for loss in parts
        if loss.litres >= WORTH_L and loss.percent >= WORTH_PERCENT and (words := _part(loss, compared))
    ]
    brakings = [one for section in compared for one in brakings_of(section)]
    for one in sorted(brakings, key=lambda b: -b.cost_j)[:BRAKINGS]:
        litres = one.cost_j * scale.l_per_j
        if litres >= WORTH_L:
            words = (
                f"Braking from {KMH * one.from_mps:.0f} to {KMH * one.to_mps:.0f} km/h at "
                f"{one.at_m / 1000.0:.1f} km cost {litres:.3f} l; lift earlier and roll."
            )
            found.append((litres, words))
    said = [words for _, words in sorted(found, key=lambda pair: -pair[0])]
    if standing.litres >= WORTH_L:
        said.append(
            f"The engine ran for {standing.seconds:.0f} s at rest: {standing.litres:.3f} l, not in the score. "
            "Switch it off where the stop is long."
        )
    return tuple(said)


def _part(loss: Loss, compared: Sequence[Compared]) -> str:
    if loss.name == "working_points":
        return f"{_shifting(compared)}: {loss.litres:.2f} l."
    if loss.name == "braking":
        return f"Brake less and roll more: the brakes took {loss.litres:.2f} l more than the best drive's."
    if loss.name == "air":
        return f"Drive more evenly: peaks of the speed cost {loss.litres:.2f} l in the air."
    if loss.name == "rolling_idle":
        return f"Keep a gear in while the car rolls, so that the fuel is cut: {loss.litres:.2f} l."
    return ""


def _shifting(compared: Sequence[Compared]) -> str:
    """Say how the engine was used, and how the best drive uses it."""
    own = [rpm for one in compared for rpm in shifts_up_rpm(one.driven)]
    best = [rpm for one in compared for rpm in shifts_up_rpm(one.best)]
    if own and best and np.median(own) > np.median(best) + SAME_RPM:
        return f"Shift up at {_round(best)} rpm instead of {_round(own)}"
    mine, theirs = (_turning(compared, which) for which in ("driven", "best"))
    if mine > theirs + SAME_RPM:
        return f"Drive in higher gears, at {theirs:.0f} rpm on average instead of {mine:.0f}"
    return "Pull harder and for a shorter time, in the engine's better working points"


def _turning(compared: Sequence[Compared], which: str) -> float:
    """Return the engine's mean speed while it is geared to the wheels, rpm."""
    drives: list[Drive] = [getattr(one, which) for one in compared]
    seconds = sum(float(drive.ride.dt_s[drive.took.pulls].sum()) for drive in drives)
    turns = sum(float((drive.ride.engine_radps * drive.ride.dt_s)[drive.took.pulls].sum()) for drive in drives)
    return turns / max(seconds, 1e-9) * 30.0 / np.pi


def _round(rpm: Sequence[float]) -> str:
    return f"{50.0 * round(float(np.median(rpm)) / 50.0):.0f}"


def brakings_of(one: Compared) -> list[Braking]:
    """Return each use of the brakes in a section."""
    ride, braked = one.driven.ride, one.driven.took.brake_w * one.driven.ride.dt_s
    price = joule_price((one.driven, one.best))
    edges = travelled_m(ride)
    at_best = travelled_m(one.best.ride)
    other = np.concatenate(([0.0], np.cumsum(one.best.took.brake_w * one.best.ride.dt_s)))
    found = []
    for begin, end in _together(ride, one.driven.took.brake_w > 0.0):
        span = np.array([max(edges[begin] - BEFORE_M, 0.0), edges[end]])
        best_j = float(np.diff(np.interp(span, at_best, other))[0])
        cost = price * (float(braked[begin:end].sum()) - best_j)
        speeds: FloatArray = ride.speed_mps[begin:end]
        if speeds[0] - speeds[-1] < LEAST_FALL_MPS:
            continue
        found.append(Braking(one.section.from_m + float(edges[begin]), float(speeds[0]), float(speeds[-1]), cost))
    return found


def _together(ride: Ride, braking: np.ndarray) -> list[tuple[int, int]]:
    """Return first row and end of each braking; a short pause in which the car gets no faster doesn't end it."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], braking, [False]))))
    found: list[tuple[int, int]] = []
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        last = found[-1][1] - 1 if found else 0
        slower = ride.speed_mps[begin] <= ride.speed_mps[last]
        if found and slower and ride.t_s[begin] - ride.t_s[last] < APART_S:
            found[-1] = (found[-1][0], end)
        else:
            found.append((begin, end))
    return found
