"""The compiled motion block against dense linear algebra, Runge–Kutta, filterpy and a Rauch–Tung–Striebel smoother."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given, settings
from hypothesis import strategies as st

from app.science.observer import motion_kernels as mk
from app.science.observer.events import MotionEvents
from app.science.observer.motion import motion_model, observe_motion
from app.science.observer.tuning import DEFAULT, THESIS_2010
from app.science.vehicle.model import Mounting, Vehicle
from tests.science.observer import dense_reference as dense

GEARS = (13.25, 9.604, 7.37, 5.796, 4.208, 3.23)
CAR = Vehicle(gear_ratios=GEARS, mounting=Mounting(0.5, -0.4, 2.0, 1.1))
MODEL = motion_model(CAR, DEFAULT)
ACCELEROMETER = (mk.ACC_I, mk.ACC_J, mk.ACC_K, mk.ACC_X, mk.ACC_Y, mk.ACC_Z)
PLAIN_KINDS = [k for k in range(mk.DISTANCE, mk.KINDS) if k != mk.DISTANCE]

states = st.builds(
    lambda v, f, psi, th, sj, sk, b: np.array([7.0, v, f, psi, th, 3.0, -4.0, 5.0, sj, sk, *b]),
    st.floats(0.0, 50.0),
    st.floats(-5000, 5000),
    st.floats(-7, 7),
    st.floats(-0.15, 0.15),
    st.floats(-0.05, 0.05),
    st.floats(-0.005, 0.005),
    st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3),
)


def dense_phi(x: np.ndarray, dt: float, mass_a: float) -> tuple[np.ndarray, np.ndarray]:
    moved, delta = x.copy(), np.zeros((7, 6))
    mk.advance(moved, dt, MODEL, mass_a, delta)
    phi = np.eye(13)
    for r, row in enumerate(mk.ROWS):
        for k, col in enumerate(mk.COLS):
            phi[row, col] += delta[r, k]
    return moved, phi


@given(states, st.floats(1e-4, 0.05), st.integers(0, 6))
@settings(max_examples=60, deadline=None)
def test_step_and_transition_equal_dense_algebra(x: np.ndarray, dt: float, gear: int) -> None:
    mass_a = float(MODEL.accelerated_mass[gear])
    moved, phi = dense_phi(x, dt, mass_a)
    expected, _, expected_phi = dense.predict(x, np.eye(13), dt, MODEL, mass_a, False)
    np.testing.assert_allclose(moved, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(phi, expected_phi, rtol=1e-9, atol=1e-12)


@given(states.filter(lambda x: x[mk.V] > 2.0), st.integers(0, 6))
@settings(max_examples=30, deadline=None)
def test_step_follows_a_runge_kutta_integration(x: np.ndarray, gear: int) -> None:
    mass_a = float(MODEL.accelerated_mass[gear])
    dt, pieces = 0.05, 20
    fine = x.copy()
    for _ in range(pieces):
        h = dt / pieces
        k1 = dense.derivative(fine, MODEL, mass_a)
        k2 = dense.derivative(fine + 0.5 * h * k1, MODEL, mass_a)
        k3 = dense.derivative(fine + 0.5 * h * k2, MODEL, mass_a)
        k4 = dense.derivative(fine + h * k3, MODEL, mass_a)
        fine = fine + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    moved, _ = dense_phi(x, dt, mass_a)
    np.testing.assert_allclose(moved, fine, rtol=0, atol=2e-3)


@given(states.filter(lambda x: x[mk.V] > 0.5))
@settings(max_examples=20, deadline=None)
def test_jacobian_has_the_papers_entries(x: np.ndarray) -> None:
    """Sebesta 2010, 3.1.2.3, with sign(v) where the paper omits it."""
    mass_a, m, g, crr = 948.0, MODEL.mass, MODEL.gravity, MODEL.crr
    a = dense.jacobian(x, MODEL, mass_a)
    v, th, psi = x[mk.V], x[mk.TH], x[mk.PSI]
    assert a[mk.V, mk.F] == pytest.approx(1 / mass_a)
    assert a[mk.V, mk.TH] == pytest.approx(m / mass_a * g * (crr * np.sin(th) - np.cos(th)), rel=1e-3)
    assert a[mk.V, mk.SK] == pytest.approx(-m / mass_a * crr * v**2, rel=1e-3)
    assert a[mk.PSI, mk.SJ] == pytest.approx(v)
    assert a[mk.N, mk.PSI] == pytest.approx(-v * np.sin(psi) * np.cos(th))
    assert a[mk.D, mk.TH] == pytest.approx(-v * np.cos(th))


@given(states, st.sampled_from(PLAIN_KINDS), st.integers(0, 6))
@settings(max_examples=80, deadline=None)
def test_measurement_rows_equal_their_derivatives(x: np.ndarray, kind: int, gear: int) -> None:
    mass_a = float(MODEL.accelerated_mass[gear])
    index, slope = np.zeros(mk.ROW, np.int64), np.zeros(mk.ROW)
    predicted, count = mk.measure(kind, x, MODEL, mass_a, index, slope)
    own = np.zeros(13)
    for k in range(count):
        own[index[k]] += slope[k]
    assert predicted == pytest.approx(float(np.real(dense.measurement(kind, x, MODEL, mass_a))), abs=1e-12)
    np.testing.assert_allclose(own, dense.row(kind, x, MODEL, mass_a), rtol=1e-10, atol=1e-12)


def some_events(seed: int, count: int = 400) -> MotionEvents:
    """A short random drive's worth of measurements of every kind, plausible enough to stay inside the gates."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0.0, 8.0, count)).round(3)
    kind = rng.choice(np.array([mk.NODE, *PLAIN_KINDS]), count)
    y = np.zeros(count)
    centre = {mk.SPEED: 15.0, mk.STANDSTILL: 15.0, mk.ACC_K: -9.8, mk.THRUST: 500.0, mk.HEADING: 0.7, mk.ALTITUDE: -5.0,
              mk.ROAD_ALTITUDE: -5.0, mk.EAST: -4.0, mk.NORTH: 3.0}  # fmt: skip
    centre |= dict(zip((mk.ACC_X, mk.ACC_Y, mk.ACC_Z), -9.8 * MODEL.acc_axes[:, 2], strict=True))
    for i, k in enumerate(kind):
        y[i] = centre.get(int(k), 0.0) + (8.0 * t[i] if k in (mk.NORTH, mk.EAST) else 0.0) + 0.1 * rng.standard_normal()
    r = np.where(np.isin(kind, ACCELEROMETER), 1.0, 4.0)
    r[kind == mk.THRUST] = 1e4
    r[kind == mk.CURVATURE_H] = 1.0
    gear = (t // 3 + 1).astype(np.int8)
    return MotionEvents(t, kind.astype(np.int8), y, r, gear, (t % 3 < 0.4).astype(np.int8))


START = np.array([0.0, 15.0, 500.0, 0.7, 0.0, 3.0, -4.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0])
START_VARIANCE = np.array([1.0, 4.0, 1e6, 0.2, 0.01, 25.0, 25.0, 25.0, 1e-3, 1e-5, 0.1, 0.1, 0.1])


@pytest.mark.parametrize("tuning", [DEFAULT, THESIS_2010], ids=lambda t: t.name)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_filter_and_smoother_equal_dense_filter_and_rauch_tung_striebel(seed: int, tuning) -> None:
    model = motion_model(CAR, tuning)
    events = some_events(seed)
    nodes = int((events.kind == mk.NODE).sum())
    filtered, smoothed = dense.run(events, model, START.copy(), np.diag(START_VARIANCE))
    for smooth, expected in ((False, filtered), (True, smoothed)):
        result = observe_motion(events, model, START, START_VARIANCE, nodes, smooth=smooth, whole_every=3)
        assert (result.innovations.accepted == 1).all()
        scale = np.sqrt(np.array([np.diag(p) for _, p in expected]))
        error = (result.state - np.array([x for x, _ in expected])) / scale
        assert np.abs(error).max() < 1e-6
        np.testing.assert_allclose(np.sqrt(result.variance), scale, rtol=1e-6)
        assert result.covariance is not None
        for own, (_, p), sd in zip(result.covariance, expected[::3], scale[::3], strict=True):
            np.testing.assert_allclose(own / np.outer(sd, sd), p / np.outer(sd, sd), atol=1e-5)


def test_smoother_does_not_care_where_the_checkpoints_lie(monkeypatch: pytest.MonkeyPatch) -> None:
    events = some_events(7, 900)
    nodes = int((events.kind == mk.NODE).sum())
    results = []
    for every in (17, 128, 1024):
        monkeypatch.setattr("app.science.observer.motion.CHECKPOINT_EVERY", every)
        results.append(observe_motion(events, MODEL, START, START_VARIANCE, nodes, smooth=True))
    for other in results[1:]:
        np.testing.assert_array_equal(other.state, results[0].state)


def test_one_correction_equals_filterpy() -> None:
    rng = np.random.default_rng(4)
    root = rng.standard_normal((13, 13))
    p = root @ root.T
    x = START.copy()
    for kind in PLAIN_KINDS:
        h = dense.row(kind, x, MODEL, 948.0)
        independent = KalmanFilter(dim_x=13, dim_z=1)
        independent.x, independent.P = x.reshape(13, 1).copy(), p.copy()
        innovation = 0.3
        independent.update(h @ x + innovation, R=2.0, H=h.reshape(1, 13))
        own_x, own_p, direction = x.copy(), p.copy(), np.zeros(13)
        index, slope = np.zeros(mk.ROW, np.int64), np.zeros(mk.ROW)
        _, count = mk.measure(kind, x, MODEL, 948.0, index, slope)
        total = mk.gain_direction(own_p, index, slope, count, direction, 2.0)
        mk.correct(own_x, own_p, direction, innovation, total)
        np.testing.assert_allclose(own_x, np.asarray(independent.x).ravel(), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(own_p, independent.P, rtol=1e-7, atol=1e-7)
