"""Straight-line fits whose uncertainty believes the data: robust, and honest about noise that has a memory."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray, IntArray

HUBER_SDS = 2.5
ROBUST_ROUNDS = 5
FEWEST_BLOCKS = 6
NEVER_SINGULAR = 1e-9
FEWEST_COUNTING = 1.5
NOT_BELIEVED = 1e4
SD_PER_MAD = 1.4826
SPEED_EDGES_MPS = (0.1, 1.5, 3.0, 5.0, 8.0, 12.0, 18.0, 25.0, 35.0)
FEWEST_AT_A_SPEED = 50


@dataclass(frozen=True, slots=True)
class Fit:
    """Coefficients of a linear fit.

    Attributes
    ----------
    value : array, shape (p,)
    influence : array, shape (blocks, p)
        By how much the coefficients differ with each block of time from those without it.
    residual : array, shape (n,)
    """

    value: FloatArray
    influence: FloatArray
    residual: FloatArray

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the coefficients, shape (p, p)."""
        return covariance_of(self.influence, self.influence)


def covariance_of(one: FloatArray, other: FloatArray) -> FloatArray:
    """Covariance between coefficients of two fits over the same blocks, shape (p, q).

    The jackknife over blocks: residuals inside a block may be correlated in any way, and where a few blocks hold most
    of what is known, leaving one out shows it.
    """
    return np.asarray(one.T @ other * (len(one) - 1) / len(one))


def blocks_of(t_s: FloatArray, block_s: float) -> IntArray:
    """Number the blocks of time that samples belong to, shape (n,): 0, 1, 2, … without holes."""
    return np.asarray(np.unique(np.floor(t_s / block_s), return_inverse=True)[1], np.int64)


def fit(design: FloatArray, y: FloatArray, block: IntArray, sd: FloatArray | float = 1.0) -> Fit:
    """Fit ``y ≈ design @ value`` by weighted least squares with Huber's weights.

    Parameters
    ----------
    design : array, shape (n, p)
    y : array, shape (n,)
    block : array of int, shape (n,)
        From `blocks_of`, of samples in order of time.
    sd : array, shape (n,), or float
        Relative standard deviation of the samples; its size doesn't matter.
    """
    scaled, target = design / np.reshape(sd, (-1, 1)), y / sd
    robust = np.ones(len(y))
    for _ in range(ROBUST_ROUNDS):
        normal = (scaled * robust[:, None]).T @ scaled
        value = np.linalg.solve(normal, scaled.T @ (robust * target))
        residual = target - scaled @ value
        spread = SD_PER_MAD * float(np.median(np.abs(residual)))
        robust = np.minimum(1.0, HUBER_SDS * spread / np.maximum(np.abs(residual), 1e-300)) if spread > 0.0 else robust
    influence = np.empty((int(block[-1]) + 1, design.shape[1]))
    told = np.empty_like(influence)
    edges = np.searchsorted(block, np.arange(len(influence) + 1))
    for index, (begin, end) in enumerate(pairwise(edges)):
        rows, weighted = scaled[begin:end], robust[begin:end, None] * scaled[begin:end]
        own = weighted.T @ rows
        without = normal * (1.0 + NEVER_SINGULAR) - own
        influence[index] = np.linalg.solve(without, weighted.T @ residual[begin:end])
        told[index] = np.diag(own)
    return Fit(value, influence * np.sqrt(np.maximum(widening(influence**2), widening(told))), residual * sd)


def widening(shares: FloatArray) -> FloatArray:
    """Factor by which a variance told by few blocks must grow, shape (p,): that of Student's distribution.

    A braking or two may hold all there is in a short trip; so few say nothing of their own uncertainty.

    Parameters
    ----------
    shares : array, shape (blocks, p)
        How much each block counts.
    """
    counting = shares.sum(axis=0) ** 2 / np.maximum((shares**2).sum(axis=0), 1e-300)
    return np.where(counting > FEWEST_COUNTING, counting / np.maximum(counting - 2.0, 0.4), NOT_BELIEVED)


def sd_over_speed(residual: FloatArray, speed_mps: FloatArray) -> FloatArray:
    """Say how much a residual scatters at each sample's speed, robustly, shape (n,)."""
    number = np.searchsorted(SPEED_EDGES_MPS, speed_mps)
    used = [rows for rows in (number == index for index in np.unique(number)) if rows.sum() >= FEWEST_AT_A_SPEED]
    if not used:
        return np.ones(len(residual))
    centre = np.array([np.median(speed_mps[rows]) for rows in used])
    spread = np.array([SD_PER_MAD * np.median(np.abs(residual[rows])) for rows in used])
    return np.asarray(np.maximum(np.interp(speed_mps, centre, spread), 1e-3))
