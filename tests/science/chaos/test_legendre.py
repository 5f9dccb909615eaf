"""The basis against NumPy's own polynomials, and the report's integrals against quadrature."""

import numpy as np
import pytest
from numpy.polynomial import Legendre

from app.science.chaos.galerkin import gauss_nodes, modes, multiplication, projected_one
from app.science.chaos.legendre import legendre, legendre_slopes, squared_norms
from app.science.chaos.legendre_kernels import fill_legendre


def test_values_and_slopes_are_those_of_legendre() -> None:
    xi = np.linspace(-1.0, 1.0, 9)
    for n in range(6):
        assert legendre(xi, 6)[n] == pytest.approx(Legendre.basis(n)(xi), abs=1e-14)
        assert legendre_slopes(xi, 6)[n] == pytest.approx(Legendre.basis(n).deriv()(xi), abs=1e-13)


def test_the_first_three_are_the_reports() -> None:
    assert legendre(0.3, 3) == pytest.approx([1.0, 0.3, 0.5 * (3.0 * 0.09 - 1.0)])


@pytest.mark.parametrize("terms", [1, 2, 3, 7])
def test_integrals_of_products(terms: int) -> None:
    nodes = gauss_nodes(terms + 1)
    at = legendre(nodes.xi, terms)
    assert (at * nodes.weights) @ at.T == pytest.approx(np.diag(squared_norms(terms)), abs=1e-14)
    products = (at * nodes.weights * nodes.xi) @ at.T / squared_norms(terms)[:, None]
    assert multiplication(terms) == pytest.approx(products, abs=1e-14)
    assert projected_one(terms) == pytest.approx(at @ nodes.weights / squared_norms(terms), abs=1e-14)


@pytest.mark.parametrize("terms", [1, 2, 3, 6])
def test_the_projected_matrix_falls_apart_at_gauss_nodes(terms: int) -> None:
    apart = modes(terms)
    back = apart.to_basis @ np.diag(apart.xi) @ np.linalg.inv(apart.to_basis)
    assert back == pytest.approx(multiplication(terms), abs=1e-13)
    assert apart.to_basis @ np.ones(terms) == pytest.approx(projected_one(terms), abs=1e-14)


def test_the_kernel_says_the_same() -> None:
    values, slopes = np.empty(6), np.empty(6)
    fill_legendre(-0.37, values, slopes)
    assert values == pytest.approx(legendre(-0.37, 6), abs=1e-15)
    assert slopes == pytest.approx(legendre_slopes(-0.37, 6), abs=1e-15)
