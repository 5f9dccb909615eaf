"""The least fuel power all the way, as the thesis has it, checked for maximality as its text asks (4.5, (4.5)-(4.11)).

The text's corner (1000 rpm, 10 Nm) is such a drive: the car nears the speed that this power keeps. (4.7) lacks ρ in p
and q, and (4.10)-(4.11) take M_a.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cbrt, exp, sqrt

import numpy as np
from scipy.integrate import solve_ivp

from app.science.arrays import FloatArray
from app.science.optimal.distance.course import Course, costate_rate
from app.science.optimal.distance.legs import Car

POINTS = 201
LONGEST_S = 1e7


@dataclass(frozen=True, slots=True)
class Steady:
    """What the thesis' formulas say of staying at the speed that the least fuel power keeps.

    Attributes
    ----------
    speed_mps : float
        ṽ (4.8).
    price_n : float
        λ_x (4.9), J/m.
    rate_1ps : float
        α (4.11).
    lambda_v : float
        λ_v(0) (4.11), J s/m.
    """

    speed_mps: float
    price_n: float
    rate_1ps: float
    lambda_v: float


def steady(car: Car, distance_m: float) -> Steady | None:
    """Return the steady drive's numbers; None where the least fuel power pushes nothing."""
    power, fuel = car.curve.cheapest_w(0.0)
    drag = car.load.drag_kgpm
    if power <= 0.0 or drag <= 0.0:
        return None
    p, q = car.load.rolling_n / drag, -power / drag
    root = sqrt(q**2 + 4.0 * p**3 / 27.0)
    v = cbrt((-q + root) / 2.0) + cbrt((-q - root) / 2.0)
    alpha = (power / v**2 + 2.0 * drag * v) / car.load.accelerated_mass_kg
    return Steady(v, fuel / v, alpha, fuel / v / alpha * (1.0 - exp(-alpha * distance_m / v)))


@dataclass(frozen=True, slots=True)
class Coasting:
    """A drive on the least fuel power.

    Attributes
    ----------
    fuel_j, time_s : float
    price_n : float
        λ_x, from H = 0 at its end.
    course : Course
    """

    fuel_j: float
    time_s: float
    price_n: float
    course: Course


def coasting(car: Car, from_mps: float, distance_m: float) -> Coasting | None:
    """Drive the distance on the least fuel power; None where the car stops before, or starts from rest."""
    power, fuel = car.curve.cheapest_w(from_mps)
    mass = car.load.accelerated_mass_kg

    def rates(_t: float, y: FloatArray) -> FloatArray:
        v = max(y[0], 1e-6)
        return np.array([(power / v - car.load.resistance_n(v)) / mass, y[0]])

    def arrived(_t: float, y: FloatArray) -> float:
        return float(y[1] - distance_m)

    def stopped(_t: float, y: FloatArray) -> float:
        return float(y[0] - 1e-3)

    if from_mps <= 1e-3:
        return None
    arrived.terminal = stopped.terminal = True  # type: ignore[attr-defined]  # how solve_ivp takes it
    found = solve_ivp(
        rates, (0.0, LONGEST_S), np.array([from_mps, 0.0]), events=(arrived, stopped), dense_output=True,
        method="LSODA", rtol=1e-9, atol=1e-9,
    )  # fmt: skip
    if not found.t_events[0].size:
        return None
    time_s = float(found.t_events[0][0])
    t = np.linspace(0.0, time_s, POINTS)
    v, x = found.sol(t)
    price = fuel / float(v[-1])
    even = np.full(POINTS, power)
    alpha, beta = costate_rate(car, v, even, price)
    costate = np.zeros(POINTS)
    for k in range(POINTS - 1, 0, -1):
        # α and β hardly change over a step: exact for their mean
        a, b = 0.5 * (alpha[k] + alpha[k - 1]), 0.5 * (beta[k] + beta[k - 1])
        kept = exp(-a * (t[k] - t[k - 1]))
        costate[k - 1] = costate[k] * kept - b * ((1.0 - kept) / a if a > 0.0 else t[k] - t[k - 1])
    return Coasting(fuel * time_s, time_s, price, Course(t, x, v, even, costate))
