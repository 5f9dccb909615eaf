"""Every filter of the family against a slow reference, and against its relatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.observer import motion_kernels as mk
from app.science.observer.events import MotionEvents
from app.science.observer.family.methods import FILTERS, Adaptation, sigma_spread
from app.science.observer.family.run import Choice, StoppedAt, run_family
from app.science.observer.motion import gates, motion_model, observe_motion
from app.science.observer.tuning import DEFAULT, THESIS_2010
from app.science.vehicle.model import Mounting, Vehicle
from tests.science.observer import family_reference as reference

GEARS = (13.25, 9.604, 7.37, 5.796, 4.208, 3.23)
CAR = Vehicle(gear_ratios=GEARS, mounting=Mounting(0.5, -0.4, 2.0, 1.1))
ACCELEROMETER = (mk.ACC_I, mk.ACC_J, mk.ACC_K, mk.ACC_X, mk.ACC_Y, mk.ACC_Z)
MODEL = motion_model(CAR, DEFAULT)
KINDS = [k for k in range(mk.SPEED, mk.KINDS) if k not in (mk.STANDSTILL, mk.REANCHOR)]
START = np.array([0.0, 15.0, 500.0, 0.7, 0.01, 3.0, -4.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0])
START_VARIANCE = np.array([1.0, 1.0, 1e5, 0.02, 1e-4, 25.0, 25.0, 25.0, 1e-5, 1e-7, 0.1, 0.1, 0.1])
ALPHA_BETA_KAPPA = (0.5, 2.0, 0.0)
STILL_GAIN = Adaptation(upper=np.inf, lower=-np.inf, window_s=1.0, gain_max=3.0)
RISING_GAIN = Adaptation(upper=-1.0, lower=-2.0, window_s=1.0, gain_max=3.0)


def drive(seed: int, count: int = 160, seconds: float = 4.0, gear: int | None = None) -> MotionEvents:
    """A few seconds of every kind of measurement along a gentle bend, inside all gates."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0.0, seconds, count)).round(3)
    kind = rng.choice(np.array([mk.NODE, *KINDS]), count).astype(np.int8)
    x, now, y = START.copy(), 0.0, np.zeros(count)
    x[mk.SJ], x[mk.SK] = 0.004, 2e-4
    gears = np.full(count, gear) if gear is not None else (t // 2 % 6 + 1)
    r = np.where(np.isin(kind, ACCELEROMETER), 1.0, 0.5)
    r[kind == mk.THRUST], r[kind == mk.CURVATURE_H], r[kind == mk.YAW_RATE] = 1e4, 1e-4, 1e-3
    r[(kind == mk.HEADING) | (kind == mk.PITCH)] = 1e-2
    for i in range(count):
        mass_a = float(MODEL.accelerated_mass[int(gears[i])])
        x = reference.midpoint(x, t[i] - now, MODEL, mass_a)
        now = t[i]
        if kind[i] != mk.NODE:
            own = np.sqrt(r[i]) if kind[i] not in ACCELEROMETER else 0.2
            y[i] = float(np.real(reference.dense.measurement(int(kind[i]), x, MODEL, mass_a)))
            y[i] += 0.5 * own * rng.standard_normal()
    return MotionEvents(t, kind, y, r, gears.astype(np.int8), (t % 2 < 0.4).astype(np.int8))


def choice(name: str, n: int = 13, adaptation: Adaptation = STILL_GAIN) -> Choice:
    return Choice(FILTERS[name], sigma_spread(n, *ALPHA_BETA_KAPPA), adaptation)


def run(name: str, events: MotionEvents, *, smooth: bool = True, model=MODEL, adaptation: Adaptation = STILL_GAIN):
    n = len(model.q)
    x0, variance0 = np.zeros(n), np.full(n, 1e5)
    x0[:13], variance0[:13] = START, START_VARIANCE
    nodes = int((events.kind == mk.NODE).sum())
    chosen = choice(name, n, adaptation)
    return run_family(chosen, events, model, x0, variance0, gates(), nodes, smooth=smooth)


def slow(name: str, events: MotionEvents, model=MODEL, gains=None):
    n = len(model.q)
    x0, variance0 = np.zeros(n), np.full(n, 1e5)
    x0[:13], variance0[:13] = START, START_VARIANCE
    if name in ("ukf", "sr-ukf"):
        own = reference.Unscented(x0, np.diag(variance0), model, *ALPHA_BETA_KAPPA)
    elif name == "aekf":
        own = reference.HighGain(x0, np.diag(variance0), model, float(model.accelerated_mass[events.gear[0]]))
    else:
        own = reference.Extended(name, x0, np.diag(variance0), model)
    return reference.run(own, events, model, gains)


def assert_same(results, expected, tolerance: float) -> None:
    """Means within so many standard deviations, deviations within so much of themselves."""
    sd = np.sqrt(np.array([np.diag(p) for _, p in expected]))
    assert np.abs((results.node_x - np.array([x for x, _ in expected])) / sd).max() < tolerance
    np.testing.assert_allclose(np.sqrt(results.node_variance), sd, rtol=tolerance)


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("seed", [1, 2])
def test_each_filter_and_its_smoother_equal_their_slow_reference(name: str, seed: int) -> None:
    events = drive(seed, gear=3 if name == "aekf" else None)
    filtered, smoothed = slow(name, events)
    forward = run(name, events, smooth=False)
    assert (forward.outcome[events.kind != mk.NODE] == 1).all()
    assert_same(forward, filtered, 1e-6)
    if name != "aekf":  # its reference carries the smoothing in z, where the points it goes through differ a little
        assert_same(run(name, events), smoothed, 1e-5)


@pytest.mark.parametrize("name", [name for name in FILTERS if name != "aekf"])
@pytest.mark.parametrize("order", [2, 3])
def test_local_polynomial_models_of_the_thrust_equal_their_reference(name: str, order: int) -> None:
    tuning = replace(DEFAULT, thrust_order=order)
    model = motion_model(CAR, tuning)
    assert len(model.q) == 12 + order
    events = drive(3)
    filtered, smoothed = slow(name, events, model)
    assert_same(run(name, events, smooth=False, model=model), filtered, 1e-6)
    assert_same(run(name, events, model=model), smoothed, 1e-4)


def test_the_dense_filter_is_the_fast_one() -> None:
    events = drive(4, 600, 10.0)
    nodes = int((events.kind == mk.NODE).sum())
    for smooth in (False, True):
        fast = observe_motion(events, MODEL, START, START_VARIANCE, nodes, smooth=smooth)
        own = run("ekf", events, smooth=smooth)
        np.testing.assert_allclose(own.node_x, fast.state, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(own.node_variance, fast.variance, rtol=1e-6)


@pytest.mark.parametrize("plain", ["ekf", "ukf"])
def test_square_root_forms_agree_to_rounding(plain: str) -> None:
    events = drive(5, 600, 10.0)
    for smooth in (False, True):
        one, other = run(plain, events, smooth=smooth), run(f"sr-{plain}", events, smooth=smooth)
        sd = np.sqrt(one.node_variance)
        assert np.abs((one.node_x - other.node_x) / sd).max() < 1e-7
        np.testing.assert_allclose(np.sqrt(other.node_variance), sd, rtol=1e-7)


@pytest.mark.parametrize("name", ["rk4-ekf", "dd-ekf", "ukf", "sr-ukf", "aekf"])
def test_all_filters_agree_within_their_uncertainty(name: str) -> None:
    events = drive(6, 1500, 20.0)
    own, ekf = run(name, events), run("ekf", events)
    assert np.abs((own.node_x - ekf.node_x) / np.sqrt(ekf.node_variance))[20:].max() < 0.5


@pytest.mark.parametrize("seed", [7, 8])
def test_high_gain_equals_its_reference_in_the_normal_form(seed: int) -> None:
    events = drive(seed, gear=2)
    own = run("aekf", events, smooth=False, adaptation=RISING_GAIN)
    assert set(np.unique(own.gain)) == {1.0, 2.0, 3.0}
    filtered, _ = slow("aekf", events, gains=own.gain)
    assert_same(own, filtered, 1e-6)


def test_the_gain_rises_while_the_model_is_wrong_and_falls_again() -> None:
    """Twelve quiet seconds, a brake that no state foresees, twelve quiet seconds."""
    t = np.arange(0.0, 30.0, 0.02)
    speed = 15.0 - 8.0 * np.clip(t - 12.0, 0.0, 1.0)
    kind = np.tile(np.array([mk.NODE, mk.DISTANCE, mk.ROAD_ALTITUDE, mk.ACC_I], np.int8), len(t) // 4 + 1)[: len(t)]
    distance = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * 0.02)])
    y = np.where(kind == mk.DISTANCE, distance, np.where(kind == mk.ROAD_ALTITUDE, -5.0, 0.0))
    y[kind == mk.ACC_I] = np.gradient(speed, t)[kind == mk.ACC_I]
    r = np.where(kind == mk.DISTANCE, 1e-4, np.where(kind == mk.ROAD_ALTITUDE, 0.1, 1.0))
    events = MotionEvents(t, kind, y, r, np.full(len(t), 3, np.int8), np.zeros(len(t), np.int8))
    own = run("aekf", events, smooth=False, adaptation=Adaptation(8.0, 2.0, 1.0, 3.0))
    quiet, braking, after = (own.gain[(t > a) & (t < b)] for a, b in ((6.0, 12.0), (13.05, 14.0), (20.0, 30.0)))
    assert quiet.max() == 1.0
    assert braking.max() > 1.0
    assert after.max() == 1.0


def test_thesis_noise_runs_through_every_filter() -> None:
    model = motion_model(CAR, THESIS_2010)
    events = drive(9)
    for name in FILTERS:
        assert np.isfinite(run(name, events, model=model).node_x).all()


def test_a_filter_that_breaks_says_when() -> None:
    events = drive(10)
    events.y[80:] = np.inf
    for name in FILTERS:
        with pytest.raises(StoppedAt) as stopped:
            run(name, events)
        assert stopped.value.t_s == pytest.approx(events.t_s[80], abs=0.5)


def test_progress_is_told_and_may_stop_the_work() -> None:
    events = drive(11)
    nodes = int((events.kind == mk.NODE).sum())
    told: list[float] = []
    run_family(choice("ekf"), events, MODEL, START, START_VARIANCE, gates(), nodes, smooth=True, progress=told.append)
    assert told[0] == 0.0
    assert told == sorted(told)
    assert told[-1] <= 1.0
