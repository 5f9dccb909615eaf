"""What Galerkin's projection makes of a differential equation with one uniformly distributed coefficient."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.chaos.legendre import legendre, squared_norms


@dataclass(frozen=True, slots=True)
class GaussNodes:
    """Where and with what weight polynomials are added up to integrate them from −1 to 1 exactly.

    Attributes
    ----------
    xi, weights : ndarray (n,)
        Good for polynomials of degree 2n − 1.
    """

    xi: FloatArray
    weights: FloatArray


@dataclass(frozen=True, slots=True)
class Modes:
    """The projected system taken apart: each mode is the equation itself at one of Gauss's nodes.

    The matrix of ⟨ξ φ_i φ_j⟩ / ⟨φ_i²⟩ has the N nodes of Gauss and Legendre as its eigenvalues, so that Galerkin's
    solution of a linear equation is the polynomial through its exact solutions at these nodes.

    Attributes
    ----------
    xi : ndarray (n,)
        The nodes.
    to_basis : ndarray (n, n)
        Makes the expansion's coefficients of the values at the nodes.
    """

    xi: FloatArray
    to_basis: FloatArray


def gauss_nodes(count: int) -> GaussNodes:
    """Return nodes and weights of Gauss and Legendre."""
    xi, weights = np.polynomial.legendre.leggauss(count)
    return GaussNodes(xi, weights)


def multiplication(terms: int) -> FloatArray:
    """Return ⟨ξ φ_i φ_j⟩ / ⟨φ_i²⟩ of the Legendre polynomials, (terms, terms) (MAUTC-2010-02, eq. 75).

    By its columns it tells what each polynomial times ξ is made of: ξ P_n = ((n + 1) P_{n+1} + n P_{n−1}) / (2n + 1).
    """
    n = np.arange(terms, dtype=np.float64)
    up, down = (n + 1.0) / (2.0 * n + 1.0), n / (2.0 * n + 1.0)
    return np.diag(up[:-1], -1) + np.diag(down[1:], 1)


def projected_one(terms: int) -> FloatArray:
    """Return ⟨φ_i⟩ / ⟨φ_i²⟩, the coefficients of the constant one, (terms,) (MAUTC-2010-02, eq. 76)."""
    return np.asarray(np.eye(1, terms)[0], dtype=np.float64)


def modes(terms: int) -> Modes:
    """Return the modes of a system that was projected on the first ``terms`` polynomials."""
    nodes = gauss_nodes(terms)
    return Modes(nodes.xi, legendre(nodes.xi, terms) * nodes.weights / squared_norms(terms)[:, None])
