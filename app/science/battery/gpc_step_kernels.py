"""One step of the five parameters, down the cost of remembered rows or to its least (MAUTC-2010-02, eqs 80 to 85).

The cost is ½ uᵀ S u with u = [1, α, α x₁₀, β φ(ξ), R]; S u is worked out where rows are remembered.
"""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import inline_kernel

ALPHA, R, BETA, XI, X10 = range(5)
COUNT = 5
DATA, CHARGE, SLOPE, RELAXATION = 0, 1, 2, 3
"""Where z keeps V₀ − V_m, C₀ x₁, C₀ and the first of q; the current is its last entry."""

CALM = 1.0
"""Sum of the diagonal of Γ·H·dt up to which the plain step is taken: it is stable below two."""


@inline_kernel
def step(
    theta: FloatArray,
    moments: FloatArray,
    phi: FloatArray,
    slopes: FloatArray,
    su: FloatArray,
    gains: FloatArray,
    dt: float,
) -> None:
    """Move the parameters down the gradient for ``dt``, given S u (MAUTC-2010-02, eqs 80 to 85), in place.

    Where the moments are so large that the plain step would swing or run away, the same law is stepped implicitly.
    """
    gradient = np.empty(COUNT)
    steep = _fill_gradient(theta, moments, phi, slopes, su, gains, gradient)
    if steep * dt <= CALM:
        for i in range(COUNT):
            theta[i] -= dt * gains[i] * gradient[i]
    else:
        hessian = np.empty((COUNT, COUNT))
        _fill_hessian(theta, moments, phi, slopes, hessian)
        _implicit(gains, hessian, gradient, dt, theta)


@inline_kernel
def solve(
    theta: FloatArray,
    moments: FloatArray,
    phi: FloatArray,
    slopes: FloatArray,
    su: FloatArray,
    variances: FloatArray,
    guess: FloatArray,
    charge_variance: float,
) -> None:
    """Take one step of Gauss and Newton to the least of the cost and of the distance to the first guess, in place."""
    gradient, hessian = np.empty(COUNT), np.empty((COUNT, COUNT))
    _fill_gradient(theta, moments, phi, slopes, su, variances, gradient)
    _fill_hessian(theta, moments, phi, slopes, hessian)
    for i in range(COUNT):
        gradient[i] += (theta[i] - guess[i]) / variances[i]
    off = (theta[ALPHA] * theta[X10] - guess[ALPHA] * guess[X10]) / charge_variance
    gradient[ALPHA] += theta[X10] * off
    gradient[X10] += theta[ALPHA] * off
    for a, by_a in ((ALPHA, theta[X10]), (X10, theta[ALPHA])):
        hessian[a, ALPHA] += by_a * theta[X10] / charge_variance
        hessian[a, X10] += by_a * theta[ALPHA] / charge_variance
    _implicit(variances, hessian, gradient, 1.0, theta)


@inline_kernel
def _fill_gradient(
    theta: FloatArray,
    moments: FloatArray,
    phi: FloatArray,
    slopes: FloatArray,
    su: FloatArray,
    gains: FloatArray,
    gradient: FloatArray,
) -> float:
    """Fill in the cost's gradient (5,), and return the sum of Γ's and the second derivatives' diagonals' products."""
    terms, last = len(phi), len(moments) - 1
    alpha, beta, x10 = theta[ALPHA], theta[BETA], theta[X10]
    gradient[ALPHA] = su[CHARGE] + x10 * su[SLOPE]
    gradient[R] = su[last]
    gradient[X10] = alpha * su[SLOPE]
    gradient[BETA], gradient[XI] = 0.0, 0.0
    steep_beta, steep_xi = 0.0, 0.0
    for i in range(terms):
        gradient[BETA] += phi[i] * su[RELAXATION + i]
        gradient[XI] += beta * slopes[i] * su[RELAXATION + i]
        for j in range(terms):
            steep_beta += phi[i] * phi[j] * moments[RELAXATION + i, RELAXATION + j]
            steep_xi += slopes[i] * slopes[j] * moments[RELAXATION + i, RELAXATION + j]
    steep_alpha = moments[CHARGE, CHARGE] + x10 * (2.0 * moments[CHARGE, SLOPE] + x10 * moments[SLOPE, SLOPE])
    steep = gains[ALPHA] * steep_alpha + gains[R] * moments[last, last] + gains[BETA] * steep_beta
    return float(steep + gains[XI] * beta * beta * steep_xi + gains[X10] * alpha * alpha * moments[SLOPE, SLOPE])


@inline_kernel
def _fill_hessian(
    theta: FloatArray, moments: FloatArray, phi: FloatArray, slopes: FloatArray, hessian: FloatArray
) -> None:
    """Fill ``hessian`` (5, 5) with D S Dᵀ, where D holds the derivatives of u by the parameters."""
    alpha, beta, x10 = theta[ALPHA], theta[BETA], theta[X10]
    terms, size = len(phi), len(moments)
    half = np.zeros((COUNT, size))
    for i in range(size):
        half[ALPHA, i] = moments[CHARGE, i] + x10 * moments[SLOPE, i]
        half[R, i] = moments[size - 1, i]
        half[X10, i] = alpha * moments[SLOPE, i]
        for j in range(terms):
            half[BETA, i] += phi[j] * moments[RELAXATION + j, i]
            half[XI, i] += beta * slopes[j] * moments[RELAXATION + j, i]
    for a in range(COUNT):
        hessian[a, ALPHA] = half[a, CHARGE] + x10 * half[a, SLOPE]
        hessian[a, R] = half[a, size - 1]
        hessian[a, X10] = alpha * half[a, SLOPE]
        hessian[a, BETA], hessian[a, XI] = 0.0, 0.0
        for j in range(terms):
            hessian[a, BETA] += phi[j] * half[a, RELAXATION + j]
            hessian[a, XI] += beta * slopes[j] * half[a, RELAXATION + j]


@inline_kernel
def _implicit(gains: FloatArray, hessian: FloatArray, gradient: FloatArray, dt: float, theta: FloatArray) -> None:
    """Take one linearly implicit step of θ' = −Γ ∇J, stable for any Γ: (1 + dt √Γ H √Γ) y = −dt √Γ ∇J, Δθ = √Γ y."""
    lower = np.zeros((COUNT, COUNT))
    y = np.empty(COUNT)
    for i in range(COUNT):
        root = np.sqrt(gains[i])
        for j in range(i + 1):
            total = dt * root * hessian[i, j] * np.sqrt(gains[j]) + (1.0 if i == j else 0.0)
            for m in range(j):
                total -= lower[i, m] * lower[j, m]
            lower[i, j] = np.sqrt(total) if i == j else total / lower[j, j]
        y[i] = -dt * root * gradient[i]
        for m in range(i):
            y[i] -= lower[i, m] * y[m]
        y[i] /= lower[i, i]
    for i in range(COUNT - 1, -1, -1):
        for m in range(i + 1, COUNT):
            y[i] -= lower[m, i] * y[m]
        y[i] /= lower[i, i]
        theta[i] += np.sqrt(gains[i]) * y[i]
