"""The compiled two-state filter and smoother against filterpy's Kalman filter and its Rauch–Tung–Striebel smoother."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from app.science.observer.pair_kernels import PAIR_LEVEL, PAIR_NODE, PAIR_RATE, PAIR_REANCHOR, filter_pair


def run(t, kind, y, r, q_level, q_rate, level_variance, rate_variance, smooth):
    nodes = int((kind == PAIR_NODE).sum())
    innovation, sd = np.zeros(len(t)), np.zeros(len(t))
    x, variance = np.empty((nodes, 2)), np.empty((nodes, 2))
    failed = filter_pair(
        t, kind, y, r, q_level, q_rate, level_variance, rate_variance, smooth, innovation, sd, x, variance
    )
    assert failed == -1
    return x, variance, innovation, sd


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_equals_filterpy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 300
    t = np.sort(rng.uniform(0, 10, n))
    kind = rng.choice([PAIR_NODE, PAIR_LEVEL, PAIR_RATE], n)
    y = np.where(kind == PAIR_RATE, 5.0, 5.0 * t) + rng.standard_normal(n)
    r = np.where(kind == PAIR_RATE, 4.0, 1.0)
    q_level, q_rate = 0.1, 30.0

    independent = KalmanFilter(dim_x=2, dim_z=1)
    independent.x, independent.P = np.zeros((2, 1)), np.diag([100.0, 1e4])
    means, covariances, transitions, noises = [], [], [], []
    now = t[0]
    for i in range(n):
        dt, now = t[i] - now, t[i]
        f = np.array([[1.0, dt], [0.0, 1.0]])
        q = np.array([[q_level * dt + q_rate * dt**3 / 3, q_rate * dt**2 / 2], [q_rate * dt**2 / 2, q_rate * dt]])
        independent.predict(F=f, Q=q)
        if kind[i] != PAIR_NODE:
            independent.update(y[i], R=r[i], H=np.array([[1.0, 0.0]] if kind[i] == PAIR_LEVEL else [[0.0, 1.0]]))
        means.append(independent.x.copy())
        covariances.append(independent.P.copy())
        transitions.append(f)
        noises.append(q)
    at_nodes = kind == PAIR_NODE
    x, variance, _, _ = run(t, kind, y, r, q_level, q_rate, 100.0, 1e4, smooth=False)
    np.testing.assert_allclose(x, np.array(means)[at_nodes, :, 0], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(variance[:, 1], np.array(covariances)[at_nodes, 1, 1], rtol=1e-6)

    # filterpy's smoother takes F[k + 1] for the step from k to k + 1
    smooth_x, smooth_p, _, _ = independent.rts_smoother(
        np.array(means), np.array(covariances), Fs=transitions, Qs=noises
    )
    x, variance, _, _ = run(t, kind, y, r, q_level, q_rate, 100.0, 1e4, smooth=True)
    np.testing.assert_allclose(x, np.asarray(smooth_x)[at_nodes, :, 0], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(variance[:, 0], np.asarray(smooth_p)[at_nodes, 0, 0], rtol=1e-5)


def test_letting_go_of_the_level_leaves_the_rate_alone() -> None:
    """Turns lost without pulses must not look like a sudden change of engine speed."""
    omega = 200.0
    before, after = np.arange(0.0, 2.0, 0.06), np.arange(5.0, 7.0, 0.06)
    lost = 777.0
    t = np.concatenate([before, [5.0], after, np.arange(0.0, 7.0, 0.05)])
    kind = np.concatenate([
        np.full(len(before), PAIR_LEVEL), [PAIR_REANCHOR], np.full(len(after), PAIR_LEVEL), np.full(140, PAIR_NODE)
    ])  # fmt: skip
    y = np.concatenate([omega * before, [0.0], omega * after + lost, np.zeros(140)])
    order = np.argsort(t, kind="stable")
    t, kind, y = t[order], kind[order], y[order]
    x, variance, _, _ = run(t, kind, y, np.full(len(t), 0.016), 1e-3, 2e3, 1.0, 1e6, smooth=True)
    node_t = t[kind == PAIR_NODE]
    known = (node_t > 0.2) & (node_t < 1.9) | (node_t > 5.1)
    np.testing.assert_allclose(x[known, 1], omega, atol=1e-3)
    in_gap = (node_t > 3.0) & (node_t < 4.0)
    assert np.sqrt(variance[in_gap, 1]).min() > 5 * np.sqrt(variance[known, 1]).max()
