"""The ball on the wheel: textbook numbers, the equations of motion, and what no other control does sooner."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from app.science.optimal.ball_and_wheel import reachable_time_s, solve_ball_and_wheel, switching
from app.science.optimal.problem import BallAndWheel, Infeasible

STATES = st.floats(-50.0, 50.0).filter(lambda x: x == 0.0 or abs(x) > 1e-3)
PUSHES = st.floats(0.05, 20.0)


@pytest.mark.parametrize(
    ("x1", "x2", "first", "switch_s", "time_s"),
    [
        (1.0, 0.0, "u_min", 1.0, 2.0),
        (-1.0, 0.0, "u_max", 1.0, 2.0),
        (0.5, -1.0, "u_max", 1.0, 1.0),
        (-0.5, 1.0, "u_min", 1.0, 1.0),
        (0.0, 0.0, "none", 0.0, 0.0),
        (0.0, 1.0, "u_min", 1.0 + np.sqrt(0.5), 1.0 + np.sqrt(2.0)),
    ],
)
def test_double_integrator(x1: float, x2: float, first: str, switch_s: float, time_s: float) -> None:
    """With γ = 1 and |u| ≤ 1 it is the double integrator: from (1, 0) one second each way."""
    found = switching(BallAndWheel(x1, x2, -1.0, 1.0, 1.0))
    assert found.first == first
    assert (found.switch_time_s, found.time_s) == pytest.approx((switch_s, time_s), abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(STATES, STATES, PUSHES, PUSHES, PUSHES)
def test_control_leads_to_rest(x1: float, x2: float, down: float, up: float, gamma: float) -> None:
    """Integrated by another hand, the two controls in turn end at rest on top."""
    problem = BallAndWheel(x1, x2, -down, up, gamma)
    found = switching(problem)
    state = np.array([x1, x2])
    order = (-down, up) if found.first == "u_min" else (up, -down)
    for u, seconds in zip(order, (found.switch_time_s, found.time_s - found.switch_time_s), strict=True):
        if seconds > 0.0:
            run = solve_ivp(lambda _t, y, u=u: [y[1], gamma * u], (0.0, seconds), state, rtol=1e-11, atol=1e-12)
            state = run.y[:, -1]
    size = abs(x1) + abs(x2) * found.time_s + x2**2 / (gamma * min(down, up)) + 1e-9
    assert np.abs(state[0]) <= 1e-8 * size
    assert np.abs(state[1]) <= 1e-8 * (abs(x2) + gamma * (up + down) * found.time_s + 1e-9)


@settings(max_examples=60, deadline=None)
@given(STATES, STATES, PUSHES, PUSHES, PUSHES)
def test_nothing_is_faster(x1: float, x2: float, down: float, up: float, gamma: float) -> None:
    """The reachable set first holds the origin at the same time; no switching locus is used there."""
    problem = BallAndWheel(x1, x2, -down, up, gamma)
    assert switching(problem).time_s == pytest.approx(reachable_time_s(problem), rel=1e-6, abs=1e-12)


def test_certificate() -> None:
    """H stays 0 with λ₂(T) = 1/(γ u), the control maximises it, and the system is controllable."""
    answer = solve_ball_and_wheel(BallAndWheel(3.0, 2.0, -2.0, 1.0, 0.5))
    certificate = answer.certificate
    assert certificate.verdict == "optimal"
    assert certificate.hamiltonian_drift_w < 1e-12
    assert certificate.max_h_minus_mu_w < 1e-12
    assert certificate.more["controllable"] is True
    assert answer.columns["lambda_2"][-1] == pytest.approx(1.0 / (0.5 * 1.0))


def test_lines_of_equal_time() -> None:
    """From everywhere on a drawn line of equal time the solution takes that time."""
    document = solve_ball_and_wheel(BallAndWheel(3.0, 2.0, -2.0, 1.0, 0.5)).document()
    for line in document["synthesis"]["isochrones"]:
        for x1, x2 in list(zip(line["x1"], line["x2"], strict=True))[::20]:
            assert switching(BallAndWheel(x1, x2, -2.0, 1.0, 0.5)).time_s == pytest.approx(line["time_s"], rel=1e-6)


@pytest.mark.parametrize(("u_min", "u_max", "limit"), [(0.0, 1.0, "u_min"), (-1.0, 0.0, "u_max"), (1.0, 2.0, "u_min")])
def test_one_sided_push(u_min: float, u_max: float, limit: str) -> None:
    """Without a push both ways the ball can't be held; the limit is named."""
    with pytest.raises(Infeasible) as refused:
        solve_ball_and_wheel(BallAndWheel(1.0, 0.0, u_min, u_max, 1.0))
    assert refused.value.limit == limit
