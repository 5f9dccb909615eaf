"""The Legendre polynomials inside hot loops; `app.science.chaos.legendre` says the same with arrays."""

from __future__ import annotations

from app.science.arrays import FloatArray
from app.science.jit import inline_kernel


@inline_kernel
def fill_legendre(xi: float, values: FloatArray, slopes: FloatArray) -> None:
    """Fill ``values`` (n,) with the first n polynomials at ``xi`` and ``slopes`` (n,) with their derivatives."""
    values[0], slopes[0] = 1.0, 0.0
    for n in range(1, len(values)):
        if n == 1:
            values[1] = xi
        else:
            values[n] = ((2 * n - 1) * xi * values[n - 1] - (n - 1) * values[n - 2]) / n
        slopes[n] = xi * slopes[n - 1] + n * values[n - 1]
