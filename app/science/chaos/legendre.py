"""Legendre polynomials as the basis of a uniformly distributed unknown between −1 and 1."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray


def legendre(xi: FloatArray | float, terms: int) -> FloatArray:
    """Return the first ``terms`` Legendre polynomials at each ``xi``, (terms, …) (MAUTC-2010-02, eq. 88)."""
    at = np.asarray(xi, dtype=np.float64)
    values = np.ones((terms, *at.shape))
    if terms > 1:
        values[1] = at
    for n in range(1, terms - 1):
        values[n + 1] = ((2 * n + 1) * at * values[n] - n * values[n - 1]) / (n + 1)
    return values


def legendre_slopes(xi: FloatArray | float, terms: int) -> FloatArray:
    """Return their derivatives by ``xi``, (terms, …)."""
    at = np.asarray(xi, dtype=np.float64)
    values = legendre(at, terms)
    slopes = np.zeros_like(values)
    for n in range(1, terms):
        slopes[n] = at * slopes[n - 1] + n * values[n - 1]
    return slopes


def squared_norms(terms: int) -> FloatArray:
    """Return the integral of each polynomial's square from −1 to 1, (terms,).

    With the first polynomial as number 1 that is 2/(2i − 1); MAUTC-2010-02, eq. 89, prints 2/(2i + 1), which counts
    from 0.
    """
    return np.asarray(2.0 / (2.0 * np.arange(terms) + 1.0), dtype=np.float64)
