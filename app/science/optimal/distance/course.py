"""A drive over time and, backwards along it, its costate by its own differential equation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.distance.extremals import Extremal
from app.science.optimal.distance.legs import PANELS, Car, Leg, run

HELD_POINTS = 31
SHOWN = np.linspace(0.0, 1.0, 41)
FINE = np.unique(np.round(np.concatenate((PANELS, SHOWN)), 12))
COARSE = SHOWN[::10]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
_POWERS = np.arange(NODES.size)
_INTEGRALS = (NODES[:, None] ** (_POWERS + 1) - (-1.0) ** (_POWERS + 1)) / (_POWERS + 1)
FROM_LEFT: FloatArray = np.asarray(np.linalg.solve(np.vander(NODES, increasing=True).T, _INTEGRALS.T).T, np.float64)
"""Integrals from −1 up to each node of what is known at all nodes."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a drive in which the control doesn't jump, each array of shape (n,).

    Attributes
    ----------
    t_s, speed_mps, distance_m : array
        From the stretch's beginning.
    power_w : array
        At the wheels.
    keep, gain : array
        λ_v here is keep · λ_v(end of the stretch) + gain.
    """

    t_s: FloatArray
    distance_m: FloatArray
    speed_mps: FloatArray
    power_w: FloatArray
    keep: FloatArray
    gain: FloatArray


@dataclass(frozen=True, slots=True)
class Course:
    """A whole drive, each array of shape (n,); where the control jumps, a time comes twice.

    Attributes
    ----------
    t_s, distance_m, speed_mps, power_w, lambda_v : array
    """

    t_s: FloatArray
    distance_m: FloatArray
    speed_mps: FloatArray
    power_w: FloatArray
    lambda_v: FloatArray


def course_of(car: Car, drive: Extremal) -> Course:
    """Return a drive over time, with λ_v(T) = 0 integrated backwards from its end."""
    known: dict[Leg, Stretch] = {}
    for part in drive.legs:
        if part not in known:
            known[part] = _moving(car, part, COARSE if drive.legs.count(part) > 1 else FINE)
    held = [_held(car, drive)] if drive.held_m > 0.0 else []
    return joined([known[part] for part in drive.there] + held + [known[part] for part in drive.away])


def joined(stretches: list[Stretch]) -> Course:
    """Put stretches one after the other."""
    costates, end = [], 0.0
    for one in reversed(stretches):
        costates.append(one.keep * end + one.gain)
        end = float(costates[-1][0])
    t, x, clock, way = [], [], 0.0, 0.0
    for one in stretches:
        t.append(clock + one.t_s)
        x.append(way + one.distance_m)
        clock, way = float(t[-1][-1]), float(x[-1][-1])
    return Course(
        np.concatenate(t), np.concatenate(x), np.concatenate([one.speed_mps for one in stretches]),
        np.concatenate([one.power_w for one in stretches]), np.concatenate(costates[::-1]),
    )  # fmt: skip


def costate_rate(car: Car, speed_mps: FloatArray, power: FloatArray, price_n: float) -> tuple[FloatArray, FloatArray]:
    """Return α and β of λ_v' = −∂H/∂v = α λ_v + β, with what a limit adds that moves with the speed (4.4, 4.10)."""
    mass = car.load.accelerated_mass_kg
    alpha = (power / speed_mps**2 + 2.0 * car.load.drag_kgpm * speed_mps) / mass
    slope, marginal = car.curve.moving_limit(speed_mps, power)
    return alpha - slope / (mass * speed_mps), marginal * slope - price_n


def _moving(car: Car, part: Leg, z: FloatArray) -> Stretch:
    middle, half = 0.5 * (z[1:] + z[:-1])[:, None], 0.5 * np.diff(z)[:, None]
    there = run(car, part.from_mps, part.to_mps, part.price_n, (middle + half * NODES).ravel())
    alpha, beta = costate_rate(car, there.speed_mps, there.power_w, part.price_n)
    v, pace, alpha, beta = (a.reshape(-1, NODES.size) for a in (there.speed_mps, there.pace_s, alpha, beta))
    dt = pace * half * WEIGHTS
    # the costate's equation is linear: over a panel it is solved by its integrating factor
    so_far = np.exp(-(alpha * pace * half) @ FROM_LEFT.T)
    keep, gain = np.exp(-(alpha * dt).sum(axis=1)), -(so_far * beta * dt).sum(axis=1)
    kept, gained = [1.0], [0.0]
    for share, more in zip(keep[::-1], gain[::-1], strict=True):
        kept.append(kept[-1] * share)
        gained.append(gained[-1] * share + more)
    t, x = (np.concatenate(([0.0], np.cumsum(step.sum(axis=1)))) for step in (dt, v * dt))
    at = run(car, part.from_mps, part.to_mps, part.price_n, z)
    shown = np.isin(z, np.round(SHOWN, 12))
    return Stretch(
        (t * part.time_s / t[-1])[shown], (x * part.distance_m / x[-1])[shown], at.speed_mps[shown], at.power_w[shown],
        np.array(kept[::-1])[shown], np.array(gained[::-1])[shown],
    )  # fmt: skip


def _held(car: Car, drive: Extremal) -> Stretch:
    time_s = drive.held_m / drive.held_mps
    t = np.linspace(0.0, time_s, HELD_POINTS)
    v = np.full(HELD_POINTS, drive.held_mps)
    power = car.resisted_w(v)
    alpha, beta = costate_rate(car, v, power, drive.price_n)
    keep = np.exp(-alpha * (time_s - t))
    return Stretch(t, v * t, v, power, keep, -beta / alpha * (1.0 - keep))
