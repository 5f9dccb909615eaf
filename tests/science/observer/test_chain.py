"""Local polynomial models of a rate against filterpy, against the pair of two states, and where they pay off."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.common import Q_continuous_white_noise
from filterpy.kalman import KalmanFilter
from scipy.linalg import expm

from app.science.observer.family.chain import filter_chain
from app.science.observer.pair_kernels import PAIR_LEVEL, PAIR_NODE, PAIR_RATE, PAIR_REANCHOR, filter_pair


def events(seed: int, count: int = 300):
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0, 10, count))
    kind = rng.choice([PAIR_NODE, PAIR_LEVEL, PAIR_RATE], count)
    y = np.where(kind == PAIR_RATE, 5.0 * np.cos(t), 5.0 * np.sin(t)) + rng.standard_normal(count)
    return t, kind, y, np.where(kind == PAIR_RATE, 4.0, 1.0)


def run(t, kind, y, r, q, start, smooth):
    nodes = int((kind == PAIR_NODE).sum())
    innovation, sd = np.zeros(len(t)), np.zeros(len(t))
    x, variance = np.empty((nodes, len(q))), np.empty((nodes, len(q)))
    assert filter_chain(t, kind, y, r, np.array(q), np.array(start), smooth, innovation, sd, x, variance) == -1
    return x, variance


@pytest.mark.parametrize("n", [3, 4])
def test_equals_filterpy(n: int) -> None:
    t, kind, y, r = events(n)
    q, start = [0.0] * (n - 1) + [30.0], [100.0] * n
    own = KalmanFilter(dim_x=n, dim_z=1)
    own.x, own.P = np.zeros((n, 1)), np.diag(start)
    means, covariances, transitions, noises, now = [], [], [], [], t[0]
    for i, time in enumerate(t):
        dt, now = time - now, time
        f = expm(np.eye(n, k=1) * dt)
        noise = Q_continuous_white_noise(n, dt, q[-1])
        own.predict(F=f, Q=noise)
        if kind[i] != PAIR_NODE:
            own.update(y[i], R=r[i], H=np.eye(n)[[0 if kind[i] == PAIR_LEVEL else 1]])
        means.append(own.x.copy())
        covariances.append(own.P.copy())
        transitions.append(f)
        noises.append(noise)
    at_nodes = kind == PAIR_NODE
    x, variance = run(t, kind, y, r, q, start, smooth=False)
    np.testing.assert_allclose(x, np.array(means)[at_nodes, :, 0], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(variance[:, 1], np.array(covariances)[at_nodes, 1, 1], rtol=1e-6)
    smooth_x, smooth_p, *_ = own.rts_smoother(np.array(means), np.array(covariances), Fs=transitions, Qs=noises)
    x, variance = run(t, kind, y, r, q, start, smooth=True)
    np.testing.assert_allclose(x, np.asarray(smooth_x)[at_nodes, :, 0], rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(variance[:, 0], np.asarray(smooth_p)[at_nodes, 0, 0], rtol=1e-4)


@pytest.mark.parametrize("smooth", [False, True])
def test_two_states_are_the_pair(smooth: bool) -> None:
    t, kind, y, r = events(9)
    kind[100] = PAIR_REANCHOR
    x, variance = run(t, kind, y, r, [0.1, 30.0], [100.0, 1e4], smooth)
    innovation, sd, pair_x, pair_variance = np.zeros(len(t)), np.zeros(len(t)), np.empty_like(x), np.empty_like(x)
    filter_pair(t, kind, y, r, 0.1, 30.0, 100.0, 1e4, smooth, innovation, sd, pair_x, pair_variance)
    np.testing.assert_allclose(x, pair_x, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(variance[:, 1], pair_variance[:, 1], rtol=1e-3)


def test_a_swinging_rate_is_followed_better() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 20.0, 0.02)
    kind = np.tile([PAIR_LEVEL, PAIR_NODE], len(t) // 2)
    y = -np.cos(2.0 * t) * 500.0 + rng.standard_normal(len(t))
    truth = 1000.0 * np.sin(2.0 * t[kind == PAIR_NODE])
    r, late = np.ones(len(t)), slice(100, None)
    errors = {}
    for n, q in ((2, [1e-6, 3e6]), (3, [1e-6, 1e-6, 3e7])):
        x, _ = run(t, kind, y, r, q, [1e6] * n, smooth=False)
        errors[n] = np.sqrt(np.mean((x[late, 1] - truth[late]) ** 2))
    assert errors[3] < 0.7 * errors[2]
