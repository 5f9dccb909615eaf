"""Regulator gains against the Riccati equations themselves, and the bracket test against Kalman's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from app.science.optimal.controllability import bracket_rank
from app.science.optimal.lqr import continuous_gain, discrete_gain

A = np.array([[0.0, 1.0], [0.0, -0.03]])
B = np.array([[0.0], [8e-5]])
Q, R = np.diag([0.01, 1.0]), np.array([[1e-8]])


def test_continuous_gain() -> None:
    """(B.7) with its minus, run in time to go until it rests, gives the same gain."""

    def rate(_s: float, s: np.ndarray) -> np.ndarray:
        m = s.reshape(2, 2)
        return np.asarray(m @ A + A.T @ m - m @ B @ np.linalg.solve(R, B.T @ m) + Q).ravel()

    rest = solve_ivp(rate, (0.0, 400.0), np.zeros(4), method="LSODA", rtol=1e-11, atol=1e-12).y[:, -1].reshape(2, 2)
    assert continuous_gain(A, B, Q, R) == pytest.approx(np.linalg.solve(R, B.T @ rest), rel=1e-7)


def test_discrete_gain() -> None:
    """The usual recursion, run until it rests, gives the same gain."""
    a, b, s = np.eye(2) + 0.1 * A, 0.1 * B, Q
    for _ in range(20_000):
        k = np.linalg.solve(b.T @ s @ b + R, b.T @ s @ a)
        s = Q + a.T @ s @ (a - b @ k)
    assert discrete_gain(a, b, Q, R) == pytest.approx(k, rel=1e-8)


def test_brackets() -> None:
    """On linear systems the rank is Kalman's; a bracket that opens only off an axis is seen off it."""
    for a, b in (
        (A, B[:, 0]),
        (np.diag([1.0, 2.0]), np.array([1.0, 0.0])),
        (np.diag([1.0, 2.0]), np.array([1.0, 1.0])),
    ):
        kalman = np.linalg.matrix_rank(np.column_stack((b, a @ b)) / [np.linalg.norm(b), np.linalg.norm(a @ b)])
        assert bracket_rank(lambda x, a=a: a @ x, lambda x, b=b: b + 0.0 * x, (0.3, -0.7)) == kalman
    f, g = (lambda x: np.array([x[1] ** 2, 0.0 * x[0]])), (lambda x: np.array([0.0 * x[0], 1.0]))
    assert bracket_rank(f, g, (0.0, 0.0)) == 1
    assert bracket_rank(f, g, (0.0, 2.0)) == 2
