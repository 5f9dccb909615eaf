"""How to stay on a drive: what power to add for being behind, and for being slow (Sebesta 2010, B.2.2)."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.science.optimal.distance.course import Course
from app.science.optimal.distance.legs import Car
from app.science.optimal.lqr import continuous_gain, discrete_gain

BEHIND_M, SLOW_MPS, SHARE = 10.0, 1.0, 0.2
"""Errors that count as much as each other, and as this share of the largest power."""
STEP_S = 0.1


def tracking(car: Car, course: Course) -> dict[str, Any]:
    """Return gains about the drive's mean speed, with the power at the wheels as control.

    ``gains`` and, for a controller that acts every ``step_s``, ``gains_stepwise``: W for a metre and for 1 m/s.
    """
    v = float(course.distance_m[-1] / course.t_s[-1])
    mass, load = car.load.accelerated_mass_kg, car.load
    a = np.array([[0.0, 1.0], [0.0, -(load.resistance_n(v) / v + 2.0 * load.drag_kgpm * v) / mass]])
    b = np.array([[0.0], [1.0 / (mass * v)]])
    q, r = np.diag([BEHIND_M**-2.0, SLOW_MPS**-2.0]), np.array([[(SHARE * car.curve.strongest_w(v)) ** -2.0]])
    # over a step that is short against −1/a₂₂ the state moves with the second-order series
    one = np.eye(2) + a * STEP_S + 0.5 * (a * STEP_S) @ (a * STEP_S)
    push = (np.eye(2) * STEP_S + 0.5 * a * STEP_S**2) @ b
    return {
        "speed_mps": v,
        "gains": continuous_gain(a, b, q, r)[0].tolist(),
        "step_s": STEP_S,
        "gains_stepwise": discrete_gain(one, push, q, r)[0].tolist(),
    }
