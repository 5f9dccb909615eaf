"""The observability normal form (Sebesta 2010, 1.2.3): there and back, its slopes, and the blocks of ż = A z + b(z)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.science.observer import motion_kernels as mk
from app.science.observer.motion import motion_model
from app.science.observer.normal_form import BLOCK_WIDTHS, SLOWEST_MPS, from_normal, normal_jacobian, to_normal
from app.science.observer.tuning import DEFAULT
from app.science.vehicle.model import Vehicle
from tests.science.observer import dense_reference as dense
from tests.science.observer.family_reference import complex_step

MODEL = motion_model(Vehicle(gear_ratios=(13.25, 9.604, 7.37, 5.796, 4.208, 3.23)), DEFAULT)
MASS_A = float(MODEL.accelerated_mass[3])
SCALE = np.array([1e3, 15.0, 2e3, 1.8, 0.06, 1e3, 1e3, 100.0, 0.02, 0.002, 0.3, 0.3, 0.3])

numbers = [
    st.floats(low, high)
    for low, high in (
        (-1e5, 1e5), (SLOWEST_MPS, 60.0), (-5e3, 5e3), (-7.0, 7.0), (-0.5, 0.5), (-1e4, 1e4), (-1e4, 1e4), (-3e3, 3e3),
        (-0.05, 0.05), (-0.005, 0.005), (-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0),
    )
]  # fmt: skip
states = st.tuples(*numbers).map(np.array)
everywhere = settings(max_examples=150, deadline=None)


def normal(x, mass_a=MASS_A):
    """Φ(x), also for complex steps."""
    z = np.zeros(13, x.dtype)
    to_normal.py_func(x, MODEL, mass_a, z)
    return z


def slopes(x):
    """∂Φ/∂x as the filter uses it, also for complex steps."""
    j = np.zeros((13, 13), x.dtype)
    normal_jacobian.py_func(x, MODEL, MASS_A, j)
    return j


@everywhere
@given(states)
def test_there_and_back_is_where_one_was(x: np.ndarray) -> None:
    z, back = np.zeros(13), np.zeros(13)
    to_normal(x, MODEL, MASS_A, z)
    assert from_normal(z, MODEL, MASS_A, back)
    np.testing.assert_allclose(back / SCALE, x / SCALE, rtol=1e-9, atol=1e-9)


@everywhere
@given(states)
def test_the_slopes_are_those_of_the_map(x: np.ndarray) -> None:
    compiled = np.zeros((13, 13))
    normal_jacobian(x, MODEL, MASS_A, compiled)
    np.testing.assert_allclose(compiled, complex_step(normal, x), rtol=1e-12, atol=1e-12)


@everywhere
@given(states)
def test_every_entry_depends_on_what_stands_above_it_only(x: np.ndarray) -> None:
    """A.4.3, Definition 1: the last entry of a block may depend on all of z, the others on their block down to them."""
    a, free = np.zeros((13, 13)), np.zeros((13, 13), bool)
    start = 0
    for width in BLOCK_WIDTHS:
        for k in range(width):
            free[start + k, start : start + k + 1] = True
            if k < width - 1:
                a[start + k, start + k + 1] = 1.0
        free[start + width - 1] = True
        start += width
    assert start == 13
    a[1, 2] = 1.0 / MASS_A
    rates = complex_step(lambda s: slopes(s) @ dense.derivative(s, MODEL, MASS_A), x) @ np.linalg.inv(slopes(x))
    assert np.abs((rates - a)[~free]).max() < 1e-6 * max(np.abs(rates).max(), 1.0)


@everywhere
@given(states)
def test_the_first_entry_of_each_block_is_measured(x: np.ndarray) -> None:
    kinds = (mk.DISTANCE, mk.HEADING, mk.NORTH, mk.EAST, mk.ALTITUDE, mk.ACC_I, mk.ACC_J, mk.ACC_K)
    first = np.cumsum((0, *BLOCK_WIDTHS[:-1]))
    measured = [float(np.real(dense.measurement(kind, x, MODEL, MASS_A))) for kind in kinds]
    np.testing.assert_allclose(normal(x)[first], measured, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("speed", [0.0, 1e-3, 0.1, 2.0, 30.0])
def test_it_gets_singular_with_the_fourth_power_of_the_speed(speed: float) -> None:
    x = np.array([5.0, speed, 900.0, 1.0, 0.1, 3.0, 4.0, 5.0, 0.01, 1e-3, 0.1, 0.1, 0.1])
    assert abs(np.linalg.det(slopes(x))) == pytest.approx(speed**4 * np.cos(0.1) ** 2, rel=1e-6, abs=1e-300)


@pytest.mark.parametrize(("speed", "climb"), [(0.0, 0.0), (0.4 * SLOWEST_MPS, 0.0), (10.0, 9.0), (np.nan, 0.0)])
def test_where_it_is_singular_the_way_back_is_refused(speed: float, climb: float) -> None:
    z, x = np.zeros(13), np.full(13, 7.0)
    z[1], z[8] = speed, climb
    assert not from_normal(z, MODEL, MASS_A, x)
    np.testing.assert_array_equal(x, 7.0)
