"""Humps that smooth curves are made of, against SciPy's B-splines and what a polynomial must give."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from app.science.roadload.splines import bending, hump_slopes, humps, products, roughness

X = np.linspace(-0.9, 3.9, 97)
LOW, HIGH, COUNT = -1.0, 4.0, 9


def reference() -> list[BSpline]:
    piece = (HIGH - LOW) / (COUNT - 2)
    knots = LOW + piece * np.arange(-2, COUNT + 1)
    return [BSpline.basis_element(knots[k : k + 4], extrapolate=False) for k in range(COUNT)]


def test_humps_and_their_slopes_are_scipys() -> None:
    values = np.column_stack([np.nan_to_num(one(X)) for one in reference()])
    slopes = np.column_stack([np.nan_to_num(one.derivative()(X)) for one in reference()])
    np.testing.assert_allclose(humps(X, LOW, HIGH, COUNT), values, atol=1e-12)
    np.testing.assert_allclose(hump_slopes(X, LOW, HIGH, COUNT), slopes, atol=1e-12)


def test_beyond_the_ends_the_value_at_the_end_holds() -> None:
    outside, ends = humps(np.array([-5.0, 9.0]), LOW, HIGH, COUNT), humps(np.array([LOW, HIGH]), LOW, HIGH, COUNT)
    np.testing.assert_allclose(outside, ends)
    assert outside.sum(axis=1) == pytest.approx([1.0, 1.0])


def test_a_plane_with_a_twist_is_not_rough() -> None:
    first, second = np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij")
    twisted = (1.0 + 2.0 * first - second + 0.5 * first * second).ravel()
    for rough in roughness(4, 5):
        assert twisted @ rough @ twisted == pytest.approx(0.0, abs=1e-9)
    bent = np.arange(5.0) ** 2
    assert bent @ bending(5) @ bent == pytest.approx(3 * 2.0**2)


def test_products_are_ordered_by_the_first_axis() -> None:
    both = products(np.array([[1.0, 2.0]]), np.array([[3.0, 5.0, 7.0]]))
    assert both.tolist() == [[3.0, 5.0, 7.0, 6.0, 10.0, 14.0]]
