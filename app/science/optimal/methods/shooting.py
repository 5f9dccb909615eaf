"""Single shooting: the augmented system is integrated from a guessed costate until it hits (Sebesta 2010, B.3.1.1).

In free time max H = 0 at the start gives the costate at once (4.4.1.1); a given time is a root in it. The control jumps
where gears change, so each gear is integrated for itself up to the event that ends it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import GEARS, NEUTRAL, DriveNumbers
from app.science.optimal.methods.field_kernels import NO_GEAR, best_gear, lead, rates_in, rows_in
from app.science.optimal.methods.found import Arc, Found, MethodFailed, joined
from app.science.optimal.methods.model import Wheels
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

SLOWEST_MPS = 1e-3
ROWS = 25
MOST_ARCS = 60
PRECISE, SMALL = 1e-11, 1e-12
LATE = 4.0
NUDGE = 1e-9
SHOTS = 60


@dataclass(frozen=True, slots=True)
class Leg:
    """One gear of a shot: the dense solution of (v, λ, distance, fuel) between two times."""

    gear: int
    begin_s: float
    end_s: float
    state: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Shot:
    """Where a costate leads: legs, the last state, and whether the speed was reached."""

    legs: tuple[Leg, ...]
    end_s: float
    last: FloatArray
    hit: bool


def single_shooting(problem: Accelerate, drive: DriveNumbers, progress: Progress) -> Found:
    """Return the extremal that arrives, in the time that is wanted.

    Raises
    ------
    MethodFailed
        When no costate leads there.
    """
    start = max(problem.from_speed_mps, SLOWEST_MPS)
    free = costate_for(drive, start, 0.0)
    horizon = LATE * (problem.time_s or 600.0)
    shots: list[float] = []

    def fire(costate: float) -> Shot:
        shots.append(costate)
        progress(min(len(shots) / SHOTS, 0.99))
        return shoot(drive, start, problem.to_speed_mps, costate, horizon)

    costate = free if problem.time_s is None else _on_time(fire, free, problem.time_s)
    found = fire(costate)
    if not found.hit:
        raise MethodFailed(
            f"from λ(0) = {costate:.6g} J s/m the drive doesn't arrive: it ends at {found.last[0]:.4g} m/s, where no "
            "gear speeds it up further; pontryagin allows for the jump of the costate at an engine's limit."
        )
    mu = rates_in(found.legs[0].gear, start, costate, drive).h_w
    more = {"shooting": {"costate_start_jspm": costate, "shots": len(shots)}}
    return told(drive, found, mu, more)


def costate_for(drive: DriveNumbers, v: float, mu: float) -> float:
    """Return the largest costate at which the greatest H is μ: H is convex in it, and there the car speeds up."""

    def h(costate: float) -> float:
        gear = best_gear(v, costate, drive)
        return rates_in(gear, v, costate, drive).h_w - mu

    if best_gear(v, 1.0, drive) == NO_GEAR:
        raise MethodFailed(f"no gear can be engaged at {v:.4g} m/s.")
    high = 1e3
    while h(high) < 0.0:
        high *= 4.0
        if high > 1e15:
            raise MethodFailed(f"the car can't speed up at {v:.4g} m/s, so no costate makes H vanish.")
    low = 0.5 * high
    while h(low) >= 0.0 and low > 1e-9:
        low, high = 0.5 * low, low
    return float(brentq(h, low, high, xtol=1e-15 * high, rtol=8.9e-16))


def shoot(drive: DriveNumbers, start_mps: float, end_mps: float, costate: float, horizon_s: float) -> Shot:
    """Integrate (v, λ, distance, fuel) until the speed is reached, the time is over, or no gear can be engaged."""
    z = np.array([start_mps, costate, 0.0, 0.0])
    t = 0.0
    legs: list[Leg] = []
    for _ in range(MOST_ARCS):
        gear = best_gear(float(z[0]), float(z[1]), drive)
        if gear == NO_GEAR:
            return Shot(tuple(legs), t, z, False)
        path = solve_ivp(
            _rates(gear, drive), (t, horizon_s), z, method="DOP853", dense_output=True,
            rtol=PRECISE, atol=SMALL * np.array([1.0, abs(costate) + 1.0, 1.0, 1e5]),
            events=_events(gear, end_mps, drive),
        )  # fmt: skip
        legs.append(Leg(gear, t, float(path.t[-1]), path.sol))
        t, z = float(path.t[-1]), path.y[:, -1]
        if path.status != 1 or len(path.t_events[0]):
            return Shot(tuple(legs), t, z, bool(len(path.t_events[0])))
        if len(path.t_events[2]):  # the gear ends at a limit of the engine's speed: H stays, the costate jumps
            z = _beyond_limit(gear, z, drive)
            if not np.isfinite(z[1]):
                return Shot(tuple(legs), t, path.y[:, -1], False)
    return Shot(tuple(legs), t, z, False)


def _rates(gear: int, drive: DriveNumbers) -> Callable[[float, FloatArray], list[float]]:
    def rates(_t: float, z: FloatArray) -> list[float]:
        now = rates_in(gear, z[0], z[1], drive)
        return [now.accel_mps2, now.costate_rate, z[0], now.fuel_w]

    return rates


def _events(gear: int, end_mps: float, drive: DriveNumbers) -> list[Any]:
    """Return what ends a leg: the speed is reached, another gear has the greater H, or the gear ends."""

    def reached(_t: float, z: FloatArray) -> float:
        return float(z[0] - end_mps)

    def overtaken(_t: float, z: FloatArray) -> float:
        return float(max(lead(gear, z[0], z[1], drive), -1e9) - NUDGE * (1.0 + abs(z[1])))

    def over(_t: float, z: FloatArray) -> float:
        return _room(gear, float(z[0]), drive)

    for event in (reached, overtaken, over):
        event.terminal = True  # type: ignore[attr-defined]  # how SciPy is told
    reached.direction = overtaken.direction = 1.0  # type: ignore[attr-defined]
    over.direction = -1.0  # type: ignore[attr-defined]
    return [reached, overtaken, over]


def _room(gear: int, v: float, drive: DriveNumbers) -> float:
    """Return how far, as a share, a speed is inside a gear's."""
    if gear == NEUTRAL or drive.kind != GEARS:
        return v - SLOWEST_MPS / 2.0
    omega = v * drive.spd_1pm[gear]
    top = drive.engine.highest_radps
    return float(min(omega - drive.engine.lowest_radps, top - omega) / top)


def _beyond_limit(gear: int, z: FloatArray, drive: DriveNumbers) -> FloatArray:
    """Return the state after a forced change of gear: H goes on, λ makes the next gear's H equal to it."""
    h = rates_in(gear, z[0], z[1], drive).h_w
    rising = z[0] * drive.spd_1pm[gear] > 0.5 * (drive.engine.lowest_radps + drive.engine.highest_radps)
    v = z[0] * (1.0 + (1e-9 if rising else -1e-9))
    after = z.copy()
    after[0] = v
    try:
        after[1] = costate_for(drive, float(v), float(h))
    except (MethodFailed, ValueError):  # no gear takes over here with this H: the shot ends
        after[1] = np.nan
    return after


def _on_time(fire: Callable[[float], Shot], free: float, time_s: float) -> float:
    """Return the costate with which the drive arrives on time; arriving never counts as late."""

    def late(costate: float) -> float:
        shot = fire(costate)
        return (shot.end_s if shot.hit else LATE * time_s) - time_s

    a, b, at_free = free, free, late(free)
    factor = 1.05 if at_free > 0.0 else 1.0 / 1.05
    for _ in range(SHOTS):
        a, b = b, b * factor
        other = late(b)
        if other == 0.0 or (other > 0.0) != (at_free > 0.0):
            return float(brentq(late, min(a, b), max(a, b), xtol=1e-13 * free, rtol=8.9e-16, maxiter=200))
        factor *= factor
    raise MethodFailed(f"no costate leads to a drive of {time_s:g} s.")


def told(drive: DriveNumbers, shot: Shot, mu: float, more: dict[str, Any]) -> Found:
    """Return a shot as a drive."""
    arcs = [arc_of(drive, leg) for leg in shot.legs if leg.end_s > leg.begin_s]
    return joined(drive, arcs, float(shot.last[3]), mu_w=mu, more=more)


def arc_of(drive: DriveNumbers, leg: Leg, rows: int = ROWS) -> Arc:
    """Return a leg at some of its times."""
    t = np.linspace(leg.begin_s, leg.end_s, rows)
    v, costate, distance, _ = leg.state(t)
    _, _, _, fuel, force, omega, torque, brake = rows_in(leg.gear, v, costate, drive)
    return Arc(leg.gear, t, distance, v, Wheels(force, fuel, omega, torque), brake, costate)
