"""A drive in a driver's words (Sebesta 2010, 4.3: "accelerate briskly rather than gently")."""

from __future__ import annotations

import numpy as np

from app.science.arrays import BoolArray
from app.science.optimal.answer import Trajectory
from app.science.optimal.problem import RADPS_PER_RPM

KMH = 3.6
STEADY_MPS2 = 1e-3
LEAST_S = 0.05
SAME_RPM = 150.0
SAME_SHARE = 0.04
MOST_LINES = 12
SWINGS = 4


def advise(trajectory: Trajectory) -> tuple[str, ...]:
    """Return what to do, in driving order."""
    pieces = _pieces(trajectory)
    doings = [_doing(trajectory, piece) for piece in pieces]
    said: list[str] = []
    k = 0
    while k < len(pieces):
        end = k
        while end + 1 < len(pieces) and {doings[end], doings[end + 1]} == {"rise", "fall"}:
            end += 1
        if end - k >= SWINGS:
            rows = slice(pieces[k + 1][0], pieces[k + 2][1])
            low, high = (f(trajectory.speed_mps[rows]) for f in (np.min, np.max))
            said.append(_sentence(trajectory, pieces[k], doings[k]))
            said.append(f"let the speed swing between {KMH * low:.1f} and {KMH * high:.1f} km/h: pull, roll, pull")
            k = end
        else:
            if _seconds(trajectory, pieces[k]) > LEAST_S:
                said.append(_sentence(trajectory, pieces[k], doings[k]))
            k += 1
    shifts = _shifts(trajectory) if len(said) <= MOST_LINES else ""
    return (*said[:MOST_LINES], *([shifts] if shifts else []))


def _pieces(t: Trajectory) -> list[tuple[int, int]]:
    """Cut a drive where gear or direction changes; ends are exclusive."""
    change = np.sign(np.where(np.abs(np.diff(t.speed_mps)) > 1e-9, np.diff(t.speed_mps), 0.0))
    within = np.diff(t.t_s) > 0.0
    cuts, begin = [], 0
    for k in range(1, len(t.t_s)):
        new = (
            not within[k - 1]
            or t.gear[k] != t.gear[k - 1]
            or (k >= 2 and within[k - 2] and change[k - 1] != change[k - 2])
        )
        if new and k - begin > 1:
            cuts.append((begin, k))
            begin = k if not within[k - 1] or t.gear[k] != t.gear[k - 1] else k - 1
        elif new:
            begin = k
    cuts.append((begin, len(t.t_s)))
    return _joined(t, cuts)


def _joined(t: Trajectory, cuts: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Join pieces of one gear in which the same is done, as pieces of a drive without gears."""
    joined: list[tuple[int, int]] = []
    for cut in cuts:
        if joined and t.gear[cut[0]] == t.gear[joined[-1][0]] and _doing(t, cut) == _doing(t, joined[-1]):
            joined[-1] = (joined[-1][0], cut[1])
        else:
            joined.append(cut)
    return joined


def _seconds(t: Trajectory, piece: tuple[int, int]) -> float:
    return float(t.t_s[piece[1] - 1] - t.t_s[piece[0]])


def _doing(t: Trajectory, piece: tuple[int, int]) -> str:
    change = float(t.speed_mps[piece[1] - 1] - t.speed_mps[piece[0]])
    seconds = _seconds(t, piece)
    if abs(change) <= STEADY_MPS2 * max(seconds, LEAST_S):
        return "hold"
    return "rise" if change > 0.0 else "fall"


def _sentence(t: Trajectory, piece: tuple[int, int], doing: str) -> str:
    rows = slice(*piece)
    end = KMH * float(t.speed_mps[piece[1] - 1])
    gear = int(t.gear[piece[0]])
    known = np.isfinite(t.torque_nm[rows])
    where = f"in gear {gear}, " if gear else ""
    pull = _span(t.torque_nm[rows][known], "Nm") if known.any() else _power(t, rows)
    braking = " and brake" if (t.brake_n[rows] > 0.0).any() else ""
    if doing == "hold":
        return f"{where}hold {end:.0f} km/h for {_seconds(t, piece):.0f} s{braking}"
    if doing == "fall":
        neutral = not gear and (t.gear > 0).any()
        return f"{'in neutral, ' if neutral else where}let the car slow down to {end:.0f} km/h{braking}"
    return f"{where}{pull} up to {end:.0f} km/h"


def _span(values: np.ndarray, unit: str) -> str:
    low, high = float(values.min()), float(values.max())
    if high - low <= SAME_SHARE * abs(high):
        return f"about {0.5 * (low + high):.0f} {unit}"
    return f"{values[0]:.0f} to {values[-1]:.0f} {unit}"


def _power(t: Trajectory, rows: slice) -> str:
    fuel = t.fuel_power_w[rows] / 1000.0
    return _span(fuel, "kW of fuel")


def _shifts(t: Trajectory) -> str:
    """Tell at which engine speeds gears are changed upwards to go on pulling; a higher gear to roll in is no shift."""
    pulls = np.append(np.diff(t.speed_mps[1:]) > 0.0, False)
    up: BoolArray = (t.gear[1:] > t.gear[:-1]) & (t.gear[:-1] > 0) & pulls
    rpm = t.engine_speed_radps[:-1][up] / RADPS_PER_RPM
    if not len(rpm):
        return ""
    middle = float(np.median(rpm))
    near = np.abs(rpm - middle) <= SAME_RPM
    if near.all():
        return f"shift up at {_round(middle)} rpm"
    others = ", ".join(_round(one) for one in rpm)
    return f"shift up at {others} rpm"


def _round(rpm: float) -> str:
    return f"{50.0 * round(rpm / 50.0):.0f}"
