"""Polynomials on an element: values and slopes at the points where a drive is looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray

DEGREE = 4
"""Of the kinetic energy over distance within an element, and the number of points where it is looked at."""
PLAIN, FROM_REST, TO_REST = 0, 1, 2
"""Kinds of elements: near standstill 1/v grows like one over the root of the distance, and points crowd there."""


@dataclass(frozen=True, slots=True)
class Basis:
    """Of one element of length 1 for each of the three kinds, stacked along the first axis.

    Attributes
    ----------
    points : array, shape (3, points)
    weights : array, shape (3, points)
        Of a quadrature.
    value, slope : array, shape (3, points, nodes)
        Of the polynomials that are 1 at one node and 0 at the others.
    upto : array, shape (3, points + 1, points)
        Integrals of a quantity over the element from its begin up to each point and to its end, from its values at
        the points times weights' own variable.
    nodes : array, shape (nodes,)
    """

    points: FloatArray
    weights: FloatArray
    value: FloatArray
    slope: FloatArray
    upto: FloatArray
    nodes: FloatArray


def _lobatto(degree: int) -> FloatArray:
    """Return the points in [0, 1] at which an interpolation is well behaved; both ends belong to them."""
    inner = np.polynomial.legendre.Legendre.basis(degree).deriv().roots()
    return np.concatenate(([0.0], 0.5 * (np.sort(inner.real) + 1.0), [1.0]))


def _made() -> Basis:
    gauss, weight = np.polynomial.legendre.leggauss(DEGREE)
    u, w = 0.5 * (gauss + 1.0), 0.5 * weight
    nodes = _lobatto(DEGREE)
    points = np.array([u, u**2, 1.0 - (1.0 - u) ** 2])
    stretch = np.array([np.ones(DEGREE), 2.0 * u, 2.0 * (1.0 - u)])
    powers = np.arange(DEGREE + 1)
    to_nodes = np.linalg.inv(np.vander(nodes, increasing=True))
    value = points[..., None] ** powers @ to_nodes
    slope = np.concatenate(
        (np.zeros((3, DEGREE, 1)), powers[1:] * points[..., None] ** (powers[1:] - 1)), axis=2
    ) @ to_nodes  # fmt: skip
    ends = np.append(u, 1.0)[:, None] ** np.arange(1, DEGREE + 1) / np.arange(1, DEGREE + 1)
    plain = ends @ np.linalg.inv(np.vander(u, increasing=True))
    return Basis(points, stretch * w, value, slope, plain * stretch[:, None, :], nodes)


BASIS = _made()
