"""Arithmetic on Taylor series in time that are cut off: sums, products, sine, cosine, tanh.

The k-th coefficient of an output along the flow is its k-th Lie derivative over k! (Sebesta 2010, Note 15), so this
gives them exactly, to rounding, without symbolic algebra.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

ComplexArray: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class Jet:
    """A series c₀ + c₁ t + c₂ t² + …, for several starts at once.

    Attributes
    ----------
    c : complex array, shape (terms, starts)
    """

    c: ComplexArray

    def __add__(self, other: Jet | float) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.c + other.c)
        moved = self.c.copy()
        moved[0] += other
        return Jet(moved)

    def __neg__(self) -> Jet:
        return Jet(-self.c)

    def __sub__(self, other: Jet | float) -> Jet:
        return self + (-other)

    def __mul__(self, other: Jet | float) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.c * other)
        product = np.empty_like(self.c)
        for k in range(len(self.c)):
            product[k] = np.sum(self.c[: k + 1] * other.c[k::-1], axis=0)
        return Jet(product)

    __radd__ = __add__
    __rmul__ = __mul__


Field: TypeAlias = Callable[[Sequence[Jet]], list[Jet]]
"""Right-hand side of ẋ = f(x), entry by entry."""
Output: TypeAlias = Callable[[Sequence[Jet]], Jet]
"""One y = h(x)."""


def sine_cosine(angle: Jet) -> tuple[Jet, Jet]:
    """Return sine and cosine, from s' = c·a' and c' = −s·a'."""
    a = angle.c
    s, c = np.empty_like(a), np.empty_like(a)
    s[0], c[0] = np.sin(a[0]), np.cos(a[0])
    for k in range(1, len(a)):
        weighted = np.arange(1, k + 1)[:, None] * a[1 : k + 1]
        s[k] = np.sum(weighted * c[k - 1 :: -1], axis=0) / k
        c[k] = -np.sum(weighted * s[k - 1 :: -1], axis=0) / k
    return Jet(s), Jet(c)


def tanh(argument: Jet) -> Jet:
    """Return the hyperbolic tangent, from t' = (1 − t²)·a'."""
    a = argument.c
    t, rest = np.empty_like(a), np.empty_like(a)
    t[0] = np.tanh(a[0])
    rest[0] = 1.0 - t[0] ** 2
    for k in range(1, len(a)):
        t[k] = np.sum(np.arange(1, k + 1)[:, None] * a[1 : k + 1] * rest[k - 1 :: -1], axis=0) / k
        rest[k] = -np.sum(t[: k + 1] * t[k::-1], axis=0)
    return Jet(t)


def flow(field: Field, start: ComplexArray, terms: int) -> list[Jet]:
    """Return the solution of ẋ = f(x) as series.

    Parameters
    ----------
    field : callable
    start : complex array, shape (states, starts)
    terms : int
        Coefficients of each series, the start among them.

    Returns
    -------
    list of Jet
        One for each state.
    """
    c = np.zeros((len(start), terms, start.shape[1]), np.complex128)
    c[:, 0] = start
    for k in range(terms - 1):
        for state, rate in enumerate(field([Jet(series[: k + 1]) for series in c])):
            c[state, k + 1] = rate.c[k] / (k + 1)
    return [Jet(series) for series in c]
