"""Taylor series and the rank test, against systems whose answer is known."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from app.science.observer import motion_kernels as mk
from app.science.observer.motion import motion_model
from app.science.observer.observability.car_system import TYPICAL, car_in_gear, field_of, outputs_of
from app.science.observer.observability.gramian import MOTION_STATES
from app.science.observer.observability.jets import Jet, flow, sine_cosine, tanh
from app.science.observer.observability.losses import situations
from app.science.observer.observability.rank import balanced, lie_derivatives, ranked
from app.science.observer.states import State
from app.science.observer.tuning import DEFAULT
from app.science.vehicle.model import Vehicle
from tests.science.observer import dense_reference as dense

VEHICLE = Vehicle(gear_ratios=(13.25, 9.604, 7.37, 5.796, 4.208, 3.23))
CAR = car_in_gear(VEHICLE, 4)
MODEL = motion_model(VEHICLE, DEFAULT)
KINDS = {
    "vss": mk.DISTANCE, "speed": mk.SPEED, "acc_i": mk.ACC_I, "acc_j": mk.ACC_J, "acc_k": mk.ACC_K,
    "heading": mk.HEADING, "pitch": mk.PITCH, "curvature_h": mk.CURVATURE_H, "yaw_rate": mk.YAW_RATE,
    "gps_north": mk.NORTH, "gps_east": mk.EAST, "gps_altitude": mk.ALTITUDE, "dem_altitude": mk.ROAD_ALTITUDE,
    "engine_torque": mk.THRUST, "standstill": mk.STANDSTILL,
}  # fmt: skip


def test_series_are_multiplied_and_bent_as_functions_are() -> None:
    a = np.array([0.3, -0.7, 0.2, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], complex)[:, None]
    jet, t = Jet(a), 0.1
    powers = t ** np.arange(12)
    value = float((powers @ a).real[0])
    sine, cosine = sine_cosine(jet)
    for series, expected in (
        (sine, np.sin(value)), (cosine, np.cos(value)), (tanh(jet), np.tanh(value)), (jet * jet - 2.0, value**2 - 2),
        (1.0 + 3.0 * jet, 1 + 3 * value),
    ):  # fmt: skip
        assert (powers @ series.c).real[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("which", range(4))
def test_the_car_moves_along_its_series_as_along_its_equations(which: int) -> None:
    x0, t = situations(CAR)[which], 0.05
    series = flow(field_of(CAR), x0[:, None].astype(complex), 17)
    moved = np.array([(t ** np.arange(17) @ one.c).real[0] for one in series])
    solved = solve_ivp(
        lambda _, s: dense.derivative(s, MODEL, CAR.accelerated_mass), (0.0, t), x0[MOTION_STATES], rtol=1e-12,
        atol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(moved[MOTION_STATES], solved.y[:, -1], rtol=1e-9, atol=1e-9)
    assert moved[State.FUEL_ENERGY] == pytest.approx(2e4 * t)
    assert moved[State.ENGINE_ANGLE] == pytest.approx(250.0 * t)


@pytest.mark.parametrize("name", KINDS)
def test_the_first_derivatives_of_each_measurement_are_those_of_its_equation(name: str) -> None:
    x0 = situations(CAR)[2]
    outputs = {name: outputs_of(CAR)[name]}
    found = lie_derivatives(field_of(CAR), outputs, x0, np.ones(17), 1.0)[name][:, MOTION_STATES]
    x, mass_a, kind = x0[MOTION_STATES], CAR.accelerated_mass, KINDS[name]
    np.testing.assert_allclose(found[0], dense.row(kind, x, MODEL, mass_a), rtol=1e-12, atol=1e-15)

    def first(state):
        return dense.row(kind, state, MODEL, mass_a) @ dense.derivative(state, MODEL, mass_a)

    steps = 1e-5 * TYPICAL[MOTION_STATES]
    slopes = [(first(x + s * e) - first(x - s * e)) / (2 * s) for s, e in zip(steps, np.eye(13), strict=True)]
    np.testing.assert_allclose(found[1] * steps, slopes * steps, rtol=1e-5, atol=1e-10)


def test_of_a_linear_system_it_is_the_criterion_of_kalman() -> None:
    rng = np.random.default_rng(5)
    a, c = rng.normal(size=(5, 5)), rng.normal(size=5)
    field = lambda x: [sum((x[j] * a[i, j] for j in range(1, 5)), x[0] * a[i, 0]) for i in range(5)]  # noqa: E731
    found = lie_derivatives(
        field, {"y": lambda x: sum((x[j] * c[j] for j in range(1, 5)), x[0] * c[0])}, np.zeros(5), np.ones(5), 1.0
    )["y"]
    expected = [c @ np.linalg.matrix_power(a, k) / factorial(k) for k in range(5)]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    assert ranked(found).rank == 5


def test_what_two_states_share_is_not_told_of_either() -> None:
    found = ranked(np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [2.0, 2.0, 1.0]]))
    assert (found.rank, found.told.tolist()) == (2, [False, False, True])
    nothing = ranked(np.zeros((1, 3)))
    assert (nothing.rank, nothing.told.tolist()) == (0, [False, False, False])


def test_blocks_of_any_unit_count_the_same() -> None:
    metres, microns = np.array([[1.0, 0.0]]), np.array([[0.0, 1e-12]])
    assert ranked(np.concatenate([metres, microns])).rank == 1
    assert ranked(balanced([metres, microns])).rank == 2


def test_the_pairs_are_their_own_normal_form() -> None:
    found = lie_derivatives(field_of(CAR), outputs_of(CAR), situations(CAR)[2], np.ones(17), 1.0)
    for name, level in (("fuel_energy", State.FUEL_ENERGY), ("engine_angle", State.ENGINE_ANGLE)):
        expected = np.zeros((17, 17))
        expected[0, level] = expected[1, level + 1] = 1.0
        np.testing.assert_allclose(found[name], expected, atol=1e-15)
