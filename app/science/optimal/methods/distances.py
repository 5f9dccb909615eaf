"""Two of the thesis' own ways over a distance: shooting for both costates, and the corner it calls optimal (4.5)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.advice import advise
from app.science.optimal.answer import Answer, Certificate, Independent, Verdict
from app.science.optimal.distance.answering import best_drive, car_of, trajectory_of
from app.science.optimal.distance.certify import beaten_by_w, controls_of, hamiltonian_w
from app.science.optimal.distance.coasting import coasting, steady
from app.science.optimal.distance.course import Course
from app.science.optimal.distance.legs import Car
from app.science.optimal.methods.field_kernels import Rates, rates_in
from app.science.optimal.methods.found import MethodFailed
from app.science.optimal.methods.judging import BEATEN, CLOSED, SMOOTH, controllable
from app.science.optimal.methods.running import Result, counted
from app.science.optimal.methods.shooting import costate_for
from app.science.optimal.problem import Accelerate, Distance, PolynomialEngine
from app.science.progress import Progress

PRECISE = 1e-10
CLOSE = 1e-5
HALVINGS = 120
ROWS = 201
SLOWEST_MPS, FASTEST_MPS = 0.5, 90.0
LONGEST_S = 1e5


@dataclass(frozen=True, slots=True)
class Ended:
    """Where a costate leads: the last time and state (v, λ_v, x, fuel), and the dense solution where it arrives."""

    time_s: float
    state: FloatArray
    dense: Callable[[FloatArray], FloatArray] | None

    @property
    def miss(self) -> float:
        """λ_v at the end, J s/m; a drive that gets stuck counts as far too low, one that runs away as too high."""
        if self.dense is not None:
            return float(self.state[1])
        return -np.inf if self.state[0] < FASTEST_MPS / 2.0 else np.inf


def corner(problem: Distance, _progress: Progress) -> Result:
    """Return the drive on the least fuel power, to be checked for maximality.

    Raises
    ------
    MethodFailed
        When the car does not get there on the least fuel power.
    """
    car = car_of(problem)
    found = coasting(car, problem.from_speed_mps, problem.distance_m)
    if found is None:
        raise MethodFailed("on the least fuel power the car stops before the end; see pontryagin.")
    at_rest = steady(car, problem.distance_m)
    numbers: dict[str, Any] = {}
    if at_rest is not None:
        numbers = {
            "speed_mps": at_rest.speed_mps,
            "lambda_x_jpm": at_rest.price_n,
            "alpha_1ps": at_rest.rate_1ps,
            "lambda_v_jspm": at_rest.lambda_v,
        }
    more = {"steady": numbers or None}
    return Result(
        found.fuel_j,
        found.time_s,
        lambda: _told(problem, car, found.course, found.price_n, found.fuel_j, "corner", more),
    )


def shooting(problem: Distance, progress: Progress) -> Result:
    """Return the extremal of 4.5.1: λ_v(0) is guessed, H = 0 gives λ_x, and λ_v must vanish at the end.

    Raises
    ------
    MethodFailed
        When numbers that are next to each other lead to ends that are far apart.
    """
    start = problem.from_speed_mps
    if start < SLOWEST_MPS:
        raise MethodFailed(f"H gives λ_x only where the car moves; start at {SLOWEST_MPS:g} m/s or more.")
    drive = drive_numbers(
        Accelerate(problem.load, problem.engine, problem.transmission, start, start + 1.0, None, problem.brake_max_n)
    )
    low, high = 0.0, costate_for(drive, start, 0.0)
    for k in range(HALVINGS):
        progress(k / HALVINGS)
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if _shot(problem, drive, middle).miss > 0.0:
            high = middle
        else:
            low = middle
    ends = [_shot(problem, drive, one) for one in (low, high)]
    arrived = [one for one in ends if one.dense is not None]
    best = min(arrived, key=lambda one: abs(one.miss), default=None)
    if best is None or abs(best.miss) > CLOSE * high:
        told = " and ".join(_words(one) for one in ends)
        raise MethodFailed(
            f"hopelessly sensitive: the two nearest values of λ_v(0), {low:.17g} and {high:.17g} J s/m, end in {told}. "
            "Shooting forwards multiplies every error along the road; pontryagin integrates over speed instead."
        )
    course, price = _course(problem, drive, best)
    more = {"shooting": {"costate_start_jspm": float(course.lambda_v[0]), "costate_end_jspm": best.miss}}
    fuel = float(best.state[3])
    return Result(
        fuel, best.time_s, lambda: _told(problem, car_of(problem), course, price, fuel, "single_shooting", more)
    )


def _price(drive: DriveNumbers, v: float, costate: float) -> float:
    """Return λ_x from max H = 0."""
    return -float(_best(drive, v, costate).h_w) / v


def _best(drive: DriveNumbers, v: float, costate: float) -> Rates:
    """Return the control with the greatest H, in gear or rolling."""
    pulling = rates_in(0, v, costate, drive)
    rolling = rates_in(-1, v, costate, drive)
    return rolling if drive.neutral and rolling.h_w > pulling.h_w else pulling


def _shot(problem: Distance, drive: DriveNumbers, costate: float) -> Ended:
    price = _price(drive, problem.from_speed_mps, costate)

    def rates(_t: float, z: FloatArray) -> list[float]:
        now = _best(drive, max(float(z[0]), SLOWEST_MPS / 2.0), float(z[1]))
        return [now.accel_mps2, now.costate_rate - price, z[0], now.fuel_w]

    def arrived(_t: float, z: FloatArray) -> float:
        return float(z[2] - problem.distance_m)

    def stuck(_t: float, z: FloatArray) -> float:
        return float(min(z[0] - SLOWEST_MPS, FASTEST_MPS - z[0]))

    arrived.terminal = stuck.terminal = True  # type: ignore[attr-defined]  # how solve_ivp takes it
    path = solve_ivp(
        rates, (0.0, LONGEST_S), np.array([problem.from_speed_mps, costate, 0.0, 0.0]), method="DOP853",
        events=(arrived, stuck), dense_output=True, rtol=PRECISE, atol=PRECISE * np.array([1.0, 1e3, 1.0, 1e4]),
    )  # fmt: skip
    return Ended(float(path.t[-1]), path.y[:, -1], path.sol if path.t_events[0].size else None)


def _course(problem: Distance, drive: DriveNumbers, found: Ended) -> tuple[Course, float]:
    assert found.dense is not None  # noqa: S101 - the caller has looked
    t = np.linspace(0.0, found.time_s, ROWS)
    v, costate, x, _ = found.dense(t)
    power = np.array([_best(drive, *one).force_n * one[0] for one in zip(v, costate, strict=True)])
    return Course(t, x, v, power, costate), _price(drive, problem.from_speed_mps, float(costate[0]))


def _words(one: Ended) -> str:
    if one.dense is not None:
        return f"λ_v(T) = {one.miss:.3g} J s/m"
    return f"{one.state[0]:.3g} m/s after {one.state[2]:.4g} m"


def _told(
    problem: Distance, car: Car, course: Course, price: float, fuel_j: float, method: str, more: dict[str, Any]
) -> Answer:
    """Return a drive as an answer, judged by maximality and by the usual one."""
    best = best_drive(problem, car).drive
    gap = (fuel_j - float(best.fuel_j)) / fuel_j
    force = 1e6 if isinstance(problem.engine, PolynomialEngine) else problem.engine.force_n[1]
    beaten = beaten_by_w(car, course, price, controls_of(problem), force)
    h = hamiltonian_w(car, course, price)
    trajectory = trajectory_of(car, course)
    peak = max(float(trajectory.fuel_power_w.max()), 1.0)
    verdict: Verdict = "best found"
    notes: tuple[str, ...] = ()
    if beaten > 1e-3 * peak or gap > BEATEN:
        verdict = "rejected"
        notes = (
            f"Rejected: another control has H − μ = {beaten:.4g} W, and the better competitor, pontryagin's drive in "
            f"{best.time_s:.1f} s, takes {best.fuel_j:.6g} J, {fuel_j - best.fuel_j:.4g} J less.",
        )
    elif max(float(np.ptp(h)), beaten) <= 10.0 * SMOOTH * peak and abs(gap) <= CLOSED:
        verdict = "extremal"
    certificate = Certificate(
        hamiltonian_drift_w=float(np.ptp(h)),
        transversality=float(abs(h[-1])),
        max_h_minus_mu_w=beaten,
        independent=Independent("the families of extremals over a distance, by integrals over speed", float(gap)),
        verdict=verdict,
        notes=notes,
        more={"controllable": controllable(problem.load, course.speed_mps)},
    )
    told = Answer(
        kind="distance",
        fuel_energy_j=fuel_j,
        time_s=float(course.t_s[-1]),
        distance_m=float(course.distance_m[-1]),
        gears=(),
        switch_speeds_mps=(),
        multiplier_w=0.0,
        trajectory=trajectory,
        costates={"distance": np.full(course.t_s.shape, price), "speed": course.lambda_v},
        advice=advise(trajectory),
        warnings=(),
        certificate=certificate,
        more={"method": method, **more},
    )
    return counted(problem, told)
