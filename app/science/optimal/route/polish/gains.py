"""The largest p F v − P of all controls at a speed: what the best of them gains when a joule of motion is worth p."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.distance.certify import controls_of
from app.science.optimal.distance.hull import lower_hull
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, Route, WillansDrive
from app.science.optimal.route.polish.burning import AtWheels, Geared, Powertrain

Gain = Callable[[FloatArray, FloatArray], FloatArray]
"""Of the worth of a joule (J/J) and the speed (m/s), W."""
POWERS, TORQUES, INNER = 4001, 161, 20
AT_LIMIT = 1e-9


def grid_gain_w(
    problem: Route, power: Powertrain, costate: FloatArray, speed_mps: FloatArray, own: IntArray | None
) -> FloatArray:
    """Return the largest gain over a grid of controls taken straight from the problem, shape (n,), W.

    Parameters
    ----------
    problem, power
    costate, speed_mps : array, shape (n,)
    own : int array, shape (n,), or None
        The gear one is in where another would have to be paid for.
    """
    if power.brakes_anywhere:
        return _at_wheels(problem, costate, speed_mps) + held_back_w(problem, power, costate, speed_mps)
    best = np.full(speed_mps.shape, -np.inf)
    share = np.linspace(0.0, 1.0, TORQUES)
    for gear, omega, low, top, able in _gears(problem, speed_mps):
        torque = low + share * np.maximum(top - low, 0.0)[:, None]
        burned = fuel_power_w(_engine(problem), omega[:, None], torque)
        gained = (costate[:, None] * torque * omega[:, None] - burned).max(axis=1)
        best = np.where(able if own is None else able & (own == gear), np.maximum(best, gained), best)
    if problem.transmission.neutral:
        roll = _rolling_w(problem, costate, speed_mps)
        best = np.maximum(best, roll if own is None else np.where(own == 0, roll, -np.inf))
    return best


def gain_of(problem: Route, power: Powertrain) -> Gain:
    """Return the largest gain of all controls, as exactly as they are known."""
    if isinstance(power, Geared):
        return lambda costate, speed: _geared(problem, power, costate, speed)
    assert isinstance(power, AtWheels)  # noqa: S101 - there is no third kind
    watts = np.linspace(*power.power_w, POWERS)
    fuel = power.curve(watts)[0]
    corners = lower_hull(watts, fuel)
    watts, fuel = watts[corners], fuel[corners]
    slopes = np.diff(fuel) / np.diff(watts)
    strongest = power.force_n[1]

    def gain(costate: FloatArray, speed_mps: FloatArray) -> FloatArray:
        best = watts[np.searchsorted(slopes, costate)]
        best = np.minimum(best, strongest * speed_mps) if np.isfinite(strongest) else best
        pulled = costate * best - np.interp(best, watts, fuel)
        return np.asarray(pulled + held_back_w(problem, power, costate, speed_mps))

    return gain


def held_back_w(problem: Route, power: Powertrain, costate: FloatArray, speed_mps: FloatArray) -> FloatArray:
    """Return what the full force against the motion gains: something where motion is worth less than nothing."""
    back = power.retards(np.maximum(speed_mps, 1e-6))
    force = problem.brake_max_n + (np.min([one.force_n for one in back], axis=0) if back else 0.0)
    return np.asarray(np.maximum(-costate, 0.0) * force * speed_mps)


def _at_wheels(problem: Route, costate: FloatArray, speed_mps: FloatArray) -> FloatArray:
    controls = controls_of(problem)
    power, fuel = controls.power_w, controls.fuel_w
    if isinstance(problem.engine, WillansDrive):
        allowed = power <= problem.engine.force_n[1] * speed_mps[:, None]
        return np.asarray(np.where(allowed, costate[:, None] * power - fuel, -np.inf).max(axis=1))
    order = np.lexsort((fuel, power))
    power, fuel = power[order], fuel[order]
    apart = np.flatnonzero(np.diff(power, prepend=-np.inf) > 0.0)
    corners = apart[lower_hull(power[apart], fuel[apart])]
    return np.asarray((costate[:, None] * power[corners] - fuel[corners]).max(axis=1))


def _engine(problem: Route) -> PolynomialEngine:
    assert isinstance(problem.engine, PolynomialEngine)  # noqa: S101 - gears have no other engine
    return problem.engine


def _gears(problem: Route, speed_mps: FloatArray) -> list[tuple[int, FloatArray, float, FloatArray, BoolArray]]:
    """Return for each gear its number, engine speeds, least and largest torques, and where it may be used."""
    engine = _engine(problem)
    found = []
    for gear, ratio in enumerate(problem.transmission.ratios, start=1):
        omega = speed_mps * ratio / problem.load.wheel_radius_m
        rpm = omega / RADPS_PER_RPM
        top = full_load_nm(engine, rpm)
        able = (rpm >= engine.speed_rpm[0] * (1.0 - AT_LIMIT)) & (rpm <= engine.speed_rpm[1] * (1.0 + AT_LIMIT))
        found.append((gear, omega, engine.torque_nm[0], top, able & (top >= engine.torque_nm[0])))
    return found


def _rolling_w(problem: Route, costate: FloatArray, speed_mps: FloatArray) -> FloatArray:
    idle = _engine(problem).idle_fuel_power_w
    return np.asarray(np.maximum(-costate, 0.0) * problem.brake_max_n * speed_mps - idle)


def _geared(problem: Route, power: Geared, costate: FloatArray, speed_mps: FloatArray) -> FloatArray:
    """Return the largest gain of all gears; where fuel is of the second degree in torque, exactly."""
    best = np.full(speed_mps.shape, -np.inf)
    for _, omega, low, top, able in _gears(problem, speed_mps):
        rows = np.polynomial.polynomial.polyval(omega, power.fuel_w)
        torques = [np.full(omega.shape, low), np.maximum(top, low)]
        if len(rows) == 3:
            bend = np.where(rows[2] > 0.0, 2.0 * rows[2], np.inf)
            torques.append(np.clip((costate * omega - rows[1]) / bend, low, torques[1]))
        elif len(rows) > 3:
            torques += [low + share * (torques[1] - low) for share in np.linspace(0.0, 1.0, 2 * INNER + 1)[1:-1]]
        gained = np.full(omega.shape, -np.inf)
        for torque in torques:
            burned = np.zeros(omega.shape)
            for row in rows[::-1]:
                burned = burned * torque + row
            gained = np.maximum(gained, costate * omega * torque - burned)
        best = np.where(able, np.maximum(best, gained), best)
    if problem.transmission.neutral:
        best = np.maximum(best, _rolling_w(problem, costate, speed_mps))
    return best
