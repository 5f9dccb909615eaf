"""Formulas through tables: as near as a polynomial comes, and nowhere below zero."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from app.science.optimal.costs.formula import fit_table
from app.science.optimal.costs.weighted import bilinear
from app.science.optimal.problem import PolynomialEngine

RPM, NM = np.array([800.0, 1500.0, 2700.0, 4100.0, 6500.0]), np.array([0.0, 15.0, 60.0, 110.0])
ENGINE = PolynomialEngine.of_phi(
    (2.5,), (1000.0, 6000.0), (10.0, 100.0), ((1000.0, 60.0), (3000.0, 100.0)), 0.0, ((0, 0),)
)


def test_tables_are_read_on_straight_lines() -> None:
    rng = np.random.default_rng(4)
    values = rng.uniform(0.0, 2.0, (RPM.size, NM.size))
    rpm, nm = rng.uniform(800.0, 6500.0, 200), rng.uniform(0.0, 110.0, 200)
    other = RegularGridInterpolator((RPM, NM), values)(np.column_stack((rpm, nm)))
    assert bilinear(tuple(RPM), tuple(NM), values, rpm, nm) == pytest.approx(other, rel=1e-12)
    assert bilinear(tuple(RPM), tuple(NM), values, np.array([0.0]), np.array([500.0]))[0] == values[0, -1]


def test_what_is_a_polynomial_is_found_with_its_few_terms() -> None:
    found = fit_table(tuple(RPM), tuple(NM), 0.1 + np.outer(RPM, NM) * 1e-5, ENGINE)
    assert found.largest < 1e-9
    assert dict(zip(found.terms, found.coefficients, strict=True))[1, 1] == pytest.approx(1e-5 * 30.0 / np.pi)
    assert max(max(term) for term in found.terms) == 1


def test_a_cliff_is_followed_as_well_as_can_be_and_never_below_zero() -> None:
    rpm, nm = np.linspace(1000.0, 6000.0, 26), np.linspace(10.0, 100.0, 19)
    cliff = np.where(nm > 80.0, 1.0, 0.0) * np.where(rpm > 4000.0, 1.0, 0.2)[:, None]
    found = fit_table(tuple(rpm), tuple(nm), cliff, ENGINE)
    speed, share = np.meshgrid(np.linspace(1000.0, 6000.0, 173), np.linspace(0.0, 1.0, 119), indexing="ij")
    top = np.interp(speed, [1000.0, 3000.0], [60.0, 100.0])
    omega, torque = speed * np.pi / 30.0, 10.0 + share * (top - 10.0)
    value = sum(c * omega**i * torque**k for (i, k), c in zip(found.terms, found.coefficients, strict=True))
    assert value.min() > -2e-3
    assert found.rms == pytest.approx(
        float(np.sqrt(np.mean((value - bilinear(tuple(rpm), tuple(nm), cliff, speed, torque)) ** 2))), rel=0.05
    )
    assert 0.01 < found.rms < 0.1
