"""Open-circuit curves against NumPy's polynomials and SciPy's monotone interpolation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from app.science.battery.curve import OpenCircuit, slope_at, soc_at, voltage_at
from app.science.battery.curve_kernels import open_circuit

POLYNOMIAL = (3.1, 1.2, -5.0, 11.0, -12.5, 6.8, -1.3)
SOC = np.linspace(0.0, 1.0, 501)


def test_polynomial_is_the_one_that_was_given() -> None:
    curve = OpenCircuit(POLYNOMIAL)
    power = np.polynomial.Polynomial(POLYNOMIAL)
    np.testing.assert_allclose(voltage_at(curve.pieces, SOC), power(SOC), rtol=1e-14)
    np.testing.assert_allclose(slope_at(curve.pieces, SOC), power.deriv()(SOC), rtol=1e-12, atol=1e-12)


def test_polynomial_of_a_part_of_the_charge_is_the_same_polynomial() -> None:
    curve = OpenCircuit(POLYNOMIAL, soc_range=(0.1, 0.9))
    inside = np.linspace(0.1, 0.9, 77)
    power = np.polynomial.Polynomial(POLYNOMIAL)
    np.testing.assert_allclose(voltage_at(curve.pieces, inside), power(inside), rtol=1e-13)


@pytest.mark.parametrize("count", [2, 3, 12])
def test_table_is_interpolated_as_pchip_does(count: int) -> None:
    rng = np.random.default_rng(count)
    soc = np.sort(rng.uniform(0.0, 1.0, count))
    volts = 3.0 + np.cumsum(rng.uniform(0.0, 0.2, count) * (rng.uniform(size=count) > 0.3))
    curve, peer = OpenCircuit(points=tuple(zip(soc, volts, strict=True))), PchipInterpolator(soc, volts)
    inside = np.linspace(soc[0], soc[-1], 300)
    np.testing.assert_allclose(voltage_at(curve.pieces, inside), peer(inside), rtol=1e-13)
    np.testing.assert_allclose(slope_at(curve.pieces, inside)[:-1], peer(inside, 1)[:-1], rtol=1e-9, atol=1e-10)


def test_outside_the_curve_goes_straight_on() -> None:
    curve = OpenCircuit(points=((0.1, 3.0), (0.5, 3.3), (0.9, 3.9)))
    ends, slopes = voltage_at(curve.pieces, np.array([0.1, 0.9])), slope_at(curve.pieces, np.array([0.1, 0.9]))
    beyond = voltage_at(curve.pieces, np.array([0.0, 1.0]))
    np.testing.assert_allclose(beyond, ends + slopes * np.array([-0.1, 0.1]), rtol=1e-13)


@pytest.mark.parametrize(
    "curve", [OpenCircuit(POLYNOMIAL), OpenCircuit(points=((0.0, 2.9), (0.2, 3.2), (0.8, 3.3), (1.0, 3.6)))]
)
def test_kernel_agrees_with_the_arrays(curve: OpenCircuit) -> None:
    soc = np.linspace(-0.2, 1.2, 141)
    told = np.array([open_circuit(curve.pieces, one) for one in soc])
    np.testing.assert_allclose(told[:, 0], voltage_at(curve.pieces, soc), rtol=1e-13)
    np.testing.assert_allclose(told[:, 1], slope_at(curve.pieces, soc), rtol=1e-12, atol=1e-12)


def test_charge_is_found_again_from_the_voltage() -> None:
    curve = OpenCircuit(points=((0.0, 2.9), (0.2, 3.2), (0.8, 3.3), (1.0, 3.6)))
    np.testing.assert_allclose(soc_at(curve, voltage_at(curve.pieces, SOC)), SOC, atol=2e-4)
    np.testing.assert_allclose(soc_at(curve, np.array([1.0, 9.0])), [0.0, 1.0])


def test_a_falling_stretch_is_found() -> None:
    curve = OpenCircuit((3.0, 1.0, -3.0, 2.5))
    stretch = curve.falls()
    assert stretch is not None
    turns = np.sort(np.polynomial.Polynomial((3.0, 1.0, -3.0, 2.5)).deriv().roots().real)
    np.testing.assert_allclose(stretch, turns, atol=1e-3)
    assert OpenCircuit((3.0, 0.5)).falls() is None
