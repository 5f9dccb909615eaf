"""Smooth curves as sums of quadratic humps, and how rough such a sum is."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray

PIECES = 2
"""Fewer pieces than humps: each hump of degree two reaches over three pieces."""


def humps(x: FloatArray, low: float, high: float, count: int) -> FloatArray:
    """Return quadratic B-splines on equal pieces, shape (n, count); beyond the ends the value at the end holds."""
    z = _places(x, low, high, count)
    rising, middle, falling = z**2 / 2.0, (-2.0 * z**2 + 6.0 * z - 3.0) / 2.0, (3.0 - z) ** 2 / 2.0
    return np.where((z < 0.0) | (z > 3.0), 0.0, np.where(z < 1.0, rising, np.where(z < 2.0, middle, falling)))


def hump_slopes(x: FloatArray, low: float, high: float, count: int) -> FloatArray:
    """Return the derivatives of `humps` by x, shape (n, count); at the ends those from inside."""
    z = _places(x, low, high, count)
    slopes = np.where(z < 1.0, z, np.where(z < 2.0, 3.0 - 2.0 * z, z - 3.0))
    return np.where((z < 0.0) | (z > 3.0), 0.0, slopes) * (count - PIECES) / (high - low)


def products(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return all products of the humps along two axes, shape (n, k l), those of the second axis next to each other."""
    return (first[:, :, None] * second[:, None, :]).reshape(len(first), -1)


def roughness(first: int, second: int) -> tuple[FloatArray, FloatArray]:
    """Return the sums of squared second differences along either axis as quadratic forms, shape (k l, k l) each."""
    along_first, along_second = np.kron(bending(first), np.eye(second)), np.kron(np.eye(first), bending(second))
    return np.asarray(along_first, dtype=np.float64), np.asarray(along_second, dtype=np.float64)


def bending(count: int) -> FloatArray:
    """Return the sum of squared second differences as a quadratic form, shape (count, count)."""
    twice = np.diff(np.eye(count), 2, axis=0)
    return np.asarray(twice.T @ twice, dtype=np.float64)


def _places(x: FloatArray, low: float, high: float, count: int) -> FloatArray:
    """Return where each x lies on each hump, which reaches from 0 to 3; shape (n, count)."""
    at = np.clip((x - low) / (high - low), 0.0, 1.0) * (count - PIECES)
    return np.asarray(at[:, None] - (np.arange(count) - PIECES)[None, :])
