"""A distance as an answer: the best drive, what was rejected for it, and how one knows."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from app.science.optimal.advice import advise
from app.science.optimal.answer import Answer, Trajectory
from app.science.optimal.distance.certify import beaten_by_w, certify, controls_of
from app.science.optimal.distance.coasting import coasting, steady
from app.science.optimal.distance.course import Course, course_of
from app.science.optimal.distance.curve import EngineCurve
from app.science.optimal.distance.extremals import Cruise, Extremal, cheapest_cruise, extremals
from app.science.optimal.distance.legs import Car
from app.science.optimal.distance.pulses import pulsed
from app.science.optimal.distance.tracking import tracking
from app.science.optimal.distance.wheel_curve import WheelCurve
from app.science.optimal.fuel_checks import concavity
from app.science.optimal.problem import RADPS_PER_RPM, Distance, Infeasible, PolynomialEngine

FREE = 1e-6
WORTH_SAYING = 0.01
KMH = 3.6


class Best(NamedTuple):
    """The best drive, what it can't go below, which is the drive itself unless pulses are needed, and the cruise."""

    drive: Extremal
    bound: Extremal
    cruise: Cruise | None


def answer(problem: Distance) -> Answer:
    """Solve a problem and say how one knows.

    Raises
    ------
    Infeasible
        When the car can't get that far, or ever slower driving takes ever less.
    """
    car = car_of(problem)
    drive, bound, cruise = best_drive(problem, car)
    course = course_of(car, drive)
    trajectory = trajectory_of(car, course)
    rejected = _coasting(problem, car, drive)
    notes = tuple(one["words"] for one in rejected if one["verdict"] == "rejected")
    warnings = _concave(problem)
    if drive is not bound and cruise is not None:
        warnings += _in_turns(car, cruise, bound, drive)
    return Answer(
        kind="distance",
        fuel_energy_j=float(drive.fuel_j),
        time_s=float(drive.time_s),
        distance_m=float(drive.distance_m),
        gears=(),
        switch_speeds_mps=(),
        multiplier_w=0.0,
        trajectory=trajectory,
        costates={"distance": np.full(course.t_s.shape, drive.price_n), "speed": course.lambda_v},
        advice=advise(trajectory),
        warnings=warnings,
        certificate=certify(problem, car, drive, course, notes),
        more={
            "bound_j": float(bound.fuel_j),
            "cruise": _cruise(cruise),
            "candidates": rejected,
            "tracking": tracking(car, course),
        },
    )


def best_drive(problem: Distance, car: Car) -> Best:
    """Return the best drive, without what is known about it.

    Raises
    ------
    Infeasible
        When the car can't get that far, or ever slower driving takes ever less.
    """
    if problem.load.drag_kgpm <= 0.0 and problem.load.rolling_n <= 0.0:
        raise Infeasible("nothing holds the car back, so no drive takes the least; give it some resistance.", "vehicle")
    cruise = cheapest_cruise(car)
    bound = _best(problem, car, cruise)
    if bound.held_m > 0.0 and cruise is not None and cruise.in_turns:
        return Best(pulsed(car, problem.from_speed_mps, bound, cruise), bound, cruise)
    return Best(bound, bound, cruise)


def car_of(problem: Distance) -> Car:
    """Return the problem's car."""
    neutral = problem.transmission.neutral
    if isinstance(problem.engine, PolynomialEngine):
        return Car(problem.load, EngineCurve.of(problem.engine, neutral))
    return Car(problem.load, WheelCurve(problem.engine, neutral))


def _best(problem: Distance, car: Car, cruise: Cruise | None) -> Extremal:
    wanted = problem.distance_m
    power, least = car.curve.cheapest_w(problem.from_speed_mps)
    free = power <= 0.0 and least <= FREE * float(car.curve.fuel_w(np.array([car.curve.strongest_w(30.0)]))[0])
    found = extremals(car, problem.from_speed_mps, wanted, None if free else cruise)
    if found:
        return min(found, key=lambda one: one.fuel_j)
    if free and cruise is not None:
        raise Infeasible(
            "no drive takes the least: rolling burns nothing, so ever slower driving takes ever less. Say what the "
            "engine burns at idle.",
            "engine.idle_fuel_power_w",
        )
    rolled = coasting_limit_m(car, problem.from_speed_mps)
    raise Infeasible(
        f"{wanted:g} m are too far by {wanted - rolled:.4g} m: the engine can't keep any speed, and the car rolls "
        f"{rolled:.4g} m.",
        "distance_m",
    )


def coasting_limit_m(car: Car, from_mps: float) -> float:
    """Return how far a car rolls that nothing pushes, m."""
    drag, rolling = car.load.drag_kgpm, car.load.rolling_n
    if rolling == 0.0:
        return float("inf")
    if drag == 0.0:
        return 0.5 * car.load.accelerated_mass_kg * from_mps**2 / rolling
    return float(0.5 * car.load.accelerated_mass_kg / drag * np.log1p(drag * from_mps**2 / rolling))


def trajectory_of(car: Car, course: Course) -> Trajectory:
    """Return a drive's course with engine speed and torque, where there is an engine to know."""
    omega = np.full(course.t_s.shape, np.nan)
    if isinstance(car.curve, EngineCurve):
        powers, back = np.unique(course.power_w, return_inverse=True)
        omega = car.curve.engine_speed(powers)[back]
    return Trajectory(
        course.t_s, course.distance_m, course.speed_mps, np.zeros(course.t_s.shape, dtype=np.int64), omega,
        course.power_w / omega, car.curve.fuel_w(course.power_w), np.zeros(course.t_s.shape),
    )  # fmt: skip


def _coasting(problem: Distance, car: Car, best: Extremal) -> list[dict[str, Any]]:
    """Check the drive on the least fuel power, and name what beats it."""
    found = coasting(car, problem.from_speed_mps, problem.distance_m)
    if found is None or found.fuel_j <= best.fuel_j * (1.0 + FREE):
        return []
    force = 1e6 if isinstance(problem.engine, PolynomialEngine) else problem.engine.force_n[1]
    beaten = beaten_by_w(car, found.course, found.price_n, controls_of(problem), force)
    fails = beaten > FREE * float(car.curve.fuel_w(found.course.power_w[:1])[0])
    power, _ = car.curve.cheapest_w(problem.from_speed_mps)
    where = f"{power:.4g} W at the wheels"
    if isinstance(car.curve, EngineCurve) and np.isfinite(omega := float(car.curve.engine_speed(np.array([power]))[0])):
        where = f"{omega / RADPS_PER_RPM:.0f} rpm, {power / omega:.1f} Nm"
    words = (
        f"The least fuel power all the way ({where}) {'is rejected' if fails else 'is an extremal, but not the best'}: "
        f"{'another control has H − μ = ' + format(beaten, '.4g') + ' W, and ' if fails else ''}it burns "
        f"{found.fuel_j:.6g} J; the better competitor, {FAMILIES[best.family]}, burns {best.fuel_j:.6g} J."
    )
    at_rest = steady(car, problem.distance_m)
    return [
        {
            "name": "least fuel power all the way",
            "fuel_energy_j": found.fuel_j,
            "time_s": found.time_s,
            "lambda_x_jpm": found.price_n,
            "lambda_v_jspm": float(found.course.lambda_v[0]),
            "max_h_minus_mu_w": beaten,
            "verdict": "rejected" if fails else "extremal",
            "better_by_j": found.fuel_j - float(best.fuel_j),
            "steady": at_rest and {
                "speed_mps": at_rest.speed_mps, "lambda_x_jpm": at_rest.price_n, "alpha_1ps": at_rest.rate_1ps,
                "lambda_v_jspm": at_rest.lambda_v,
            },
            "words": words,
        }
    ]  # fmt: skip


FAMILIES = {
    "straight": "one control after the other without turning round",
    "turn": "speeding up, then coasting",
    "cruise": "going to the cheapest speed, holding it, then coasting",
    "pulses": "pulse and glide about the cheapest speed, then coasting",
}


def _cruise(cruise: Cruise | None) -> dict[str, Any] | None:
    if cruise is None:
        return None
    return {
        "speed_mps": cruise.speed_mps, "fuel_jpm": cruise.price_n, "powers_w": [cruise.low_w, cruise.high_w],
        "in_turns": cruise.in_turns,
    }  # fmt: skip


def _concave(problem: Distance) -> tuple[str, ...]:
    found = concavity(problem.engine)
    if found is None or found.share < WORTH_SAYING:
        return ()
    return (f"Fuel power is not convex: it is concave in {100.0 * found.share:.0f} % of what the engine can do.",)


def _in_turns(car: Car, cruise: Cruise, bound: Extremal, drive: Extremal) -> tuple[str, ...]:
    v = np.array([cruise.speed_mps])
    steady_w = float(car.curve.fuel_w(car.resisted_w(v))[0])
    mixed_w = cruise.price_n * cruise.speed_mps
    pulses = sum(
        1 for a, b in zip(drive.legs, drive.legs[1:], strict=False) if a.to_mps < a.from_mps and b.to_mps > b.from_mps
    )
    low, high = cruise.low_w / 1e3, cruise.high_w / 1e3
    more = drive.fuel_j - bound.fuel_j
    return (
        f"No classical optimum exists: fuel power isn't convex in wheel power, and about {KMH * cruise.speed_mps:.1f} "
        f"km/h {low:.3g} and {high:.3g} kW in turn take {mixed_w:.0f} W on average, holding the speed "
        f"{steady_w:.0f} W. The answer pulses {pulses} times and burns {more:.3g} J more than infinitely many pulses "
        "would.",
    )
