"""Injector flow and lag from the litres at the pump: nothing in a drive alone tells them.

A lag makes every pulse longer by the same, and so does the part of the engine's friction that depends on nothing: both
are fuel per cycle at no load. Only litres tell them apart. Over a tank, litres = flow · (Σ duration + lag · pulses), so
tanks with pulses of different mean length tell both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.calibration.evidence import TripEvidence
from app.science.errors import TooLittleData
from app.science.logger.recording import Recording
from app.science.observer.prepass import pulses_between
from app.science.vehicle.model import Injection

PUMP_SHARE = 0.003
FULL_TO_L = 0.15
"""A pump's error, and how well two fills stop at the same level."""
LEAST_SHARE = 0.0005
ENOUGH_FILLS = 4
LAG_SD_S = 1e-4
"""How well a lag from a data sheet is known."""
SHORTEST_QUANTILE = 0.001


@dataclass(frozen=True, slots=True)
class Fills:
    """Litres of tanks and the pulses that they went through, arrays of shape (n,)."""

    litres: FloatArray
    pulses: FloatArray
    seconds: FloatArray
    trips: int


@dataclass(frozen=True, slots=True)
class Injectors:
    """Flow, l/s, and lag, s, with their covariance (2, 2)."""

    flow_lps: float
    lag_s: float
    covariance: FloatArray


def pulses_seen(recording: Recording) -> dict[str, float]:
    """Return the totals of a trip's pulses as in `TripEvidence`; nothing without pulses."""
    pulses = recording.get("injector_pulse_s")
    if pulses is None or len(pulses) < 2:
        return {}
    stands_for = pulses_between(pulses.t_s)
    return {
        "pulse_count": float(stands_for.sum()),
        "pulse_s": float(stands_for @ pulses.value),
        "shortest_pulse_s": float(np.quantile(pulses.value, SHORTEST_QUANTILE)),
    }


def fills_of(evidences: Sequence[TripEvidence], refuelled_l: float | Sequence[float | None] | None) -> Fills:
    """Join trips into tanks: each fill pays for the trips since the one before it.

    Raises
    ------
    TooLittleData
        When the litres are neither one number nor one entry per trip.
    """
    if refuelled_l is None:
        return Fills(np.zeros(0), np.zeros(0), np.zeros(0), 0)
    after: list[float | None] = [None] * (len(evidences) - 1)
    after = [*after, refuelled_l] if isinstance(refuelled_l, int | float) else list(refuelled_l)
    if len(after) != len(evidences):
        raise TooLittleData(f"There are {len(evidences)} trips and litres for {len(after)}: give one entry per trip.")
    rows, count, seconds, trips, waiting = [], 0.0, 0.0, 0, 0
    for evidence, litres in zip(evidences, after, strict=True):
        count += evidence.numbers.get("pulse_count", 0.0)
        seconds += evidence.numbers.get("pulse_s", 0.0)
        waiting += 1
        if litres is not None and litres > 0.0:
            if count:
                rows.append((litres, count, seconds))
                trips += waiting
            count, seconds, waiting = 0.0, 0.0, 0
    columns = np.array(rows, np.float64).reshape(-1, 3).T
    return Fills(columns[0], columns[1], columns[2], trips)


def both_from(fills: Fills, injection: Injection) -> Injectors | None:
    """Fit flow and lag; None from less than two fills.

    With `ENOUGH_FILLS` the scatter of the fills tells their error; with fewer, what is usual at a pump.
    """
    if len(fills.litres) < 2:
        return None
    enough = len(fills.litres) >= ENOUGH_FILLS
    sd = LEAST_SHARE * fills.litres if enough else np.hypot(PUMP_SHARE * fills.litres, FULL_TO_L)
    design = np.column_stack([fills.seconds, fills.pulses]) / sd[:, None]
    size = np.linalg.norm(design, axis=0)
    normal = (design / size).T @ (design / size)
    if np.linalg.cond(normal) > 1e8:
        return None
    covariance = np.linalg.inv(normal) / np.outer(size, size)
    value = covariance @ design.T @ (fills.litres / sd)
    if enough:
        left = fills.litres / sd - design @ value
        covariance = covariance * max(float(left @ left) / (len(left) - 2), 1.0)
    if value[0] <= 0.0:
        return None
    share = 1.0 / injection.groups if injection.pattern == "grouped" else 1.0
    flow, lag = value[0], value[1] / value[0]
    slope = np.array([[1.0 / share, 0.0], [-lag / flow, 1.0 / flow]])
    return Injectors(float(flow / share), float(lag), slope @ covariance @ slope.T)


def flow_from(fills: Fills, injection: Injection) -> Injectors | None:
    """Fit the flow alone with the file's lag; None without a fill or where that lag leaves no fuel at all."""
    open_s = fills.seconds + injection.lag_s * fills.pulses
    if not len(open_s) or open_s.min() <= 0.0:
        return None
    share = 1.0 / injection.groups if injection.pattern == "grouped" else 1.0
    sd = np.hypot(PUMP_SHARE * fills.litres, FULL_TO_L)
    weight = open_s / sd
    flow = float(weight @ (fills.litres / sd) / (weight @ weight))
    by_lag = flow * LAG_SD_S * float(fills.pulses.sum() / open_s.sum())
    variance = (1.0 / float(weight @ weight) + by_lag**2) / share**2
    return Injectors(flow / share, injection.lag_s, np.diag([variance, LAG_SD_S**2]))
