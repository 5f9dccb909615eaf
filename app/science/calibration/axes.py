"""Where the raw accelerometer sees the car's axes: forward by braking and accelerating, right by bends, down by both.

Slopes pull along the car's forward axis only, squat and roll likewise act along the axis that causes them; so none of
them turns a direction found by regression, whatever they do to its length. A constant bias is no part of it either.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from app.science.arrays import BoolArray, FloatArray
from app.science.calibration.blocks import FEWEST_BLOCKS, blocks_of, covariance_of, fit, sd_over_speed
from app.science.calibration.evidence import Estimate
from app.science.calibration.motion import STEP_S, Motion, without_slow_part

BLOCK_S = 20.0
LATEST_S = 2.0
SLOW_S = 30.0
SCATTER_ROUNDS = 2
LEVEL_ROUNDS = 4
LEVEL_BLOCK_S = 60.0
SLOPE_S = 1.5
VAGUE_RAD = 0.2
"""A direction known worse than this is no direction."""


def axes_seen(motion: Motion) -> dict[str, Estimate]:
    """Estimate ``forward``, ``right`` and ``gravity`` of `TripEvidence`, as far as the trip tells them."""
    if not enough(motion.t_s, motion.has_forward):
        return {}
    late = 0 if motion.source == "vss_tick" else latest(motion, motion.forward_mps2, motion.has_forward)
    causes = {"forward": (np.roll(motion.forward_mps2, -late), np.roll(motion.has_forward, -late))}
    if enough(motion.t_s, motion.has_right):
        late = latest(motion, motion.right_mps2, motion.has_right)
        causes["right"] = np.roll(motion.right_mps2, -late), np.roll(motion.has_right, -late)
    known = np.all([motion.has_forward, *(where for _, where in causes.values())], axis=0)
    if not enough(motion.t_s, known):
        return {}
    seen = columns(motion, np.column_stack([cause for cause, _ in causes.values()]), known)
    found = {name: column for name, column in zip(causes, seen, strict=True) if is_clear(column)}
    found["gravity"] = gravity(motion, motion.has_forward)
    if "forward" in found:
        found["level"] = level(motion, motion.has_forward, np.array(found["forward"].value), found["gravity"])
    return found


def enough(t_s: FloatArray, known: BoolArray) -> bool:
    """Whether there are blocks of time enough to tell an uncertainty from."""
    return bool(np.count_nonzero(known) * STEP_S > FEWEST_BLOCKS * BLOCK_S)


def gravity(motion: Motion, known: BoolArray) -> Estimate:
    """Mean reading while driving, m/s²: gravity and bias."""
    raw, block = motion.raw_mps2[known], blocks_of(motion.t_s[known], BLOCK_S)
    fits = [fit(np.ones((len(raw), 1)), raw[:, axis], block) for axis in range(3)]
    influence = np.column_stack([one.influence[:, 0] for one in fits])
    return Estimate.of(np.array([one.value[0] for one in fits]), covariance_of(influence, influence))


def latest(motion: Motion, cause: FloatArray, known: BoolArray) -> int:
    """Steps by which the cause's signal lags behind the accelerometer: where it explains most of what was read."""
    raw = without_slow_part(motion.raw_mps2, known.astype(np.float64), SLOW_S)
    reach = round(LATEST_S / STEP_S)
    explained = []
    for late in range(-reach, reach + 1):
        both = known & np.roll(known, -late)
        moved = without_slow_part(np.roll(cause, -late), both.astype(np.float64), SLOW_S)[both]
        explained.append(float(np.sum((moved @ raw[both]) ** 2)) / max(float(moved @ moved), 1e-12))
    return int(np.argmax(explained)) - reach


def columns(motion: Motion, causes: FloatArray, known: BoolArray) -> list[Estimate]:
    """What a unit of each acceleration, (n, k), makes the raw axes read: k estimates of shape (3,).

    The samples are weighted in axes in which the noise is least correlated, each with its scatter at that speed:
    wheels and road shake a car most upwards and at high speed.
    """
    speed, block = motion.speed_mps[known], blocks_of(motion.t_s[known], BLOCK_S)
    even = known.astype(np.float64)
    design, raw = (without_slow_part(signal, even, SLOW_S)[known] for signal in (causes, motion.raw_mps2))
    plain = np.column_stack([fit(design, raw[:, axis], block).residual for axis in range(3)])
    own_axes = np.linalg.eigh(plain.T @ plain)[1].T
    fits = []
    for turned, residual in zip((motion.raw_mps2 @ own_axes.T).T, (plain @ own_axes.T).T, strict=True):
        for _ in range(SCATTER_ROUNDS):
            scatter = sd_over_speed(residual, speed)
            weight = np.zeros(len(known))
            weight[known] = scatter**-2
            design, y = (without_slow_part(signal, weight, SLOW_S)[known] for signal in (causes, turned))
            found = fit(design, y, block, scatter)
            residual = found.residual
        fits.append(found)
    seen = []
    for index in range(causes.shape[1]):
        influence = np.column_stack([one.influence[:, index] for one in fits])
        value = np.array([one.value[index] for one in fits])
        seen.append(Estimate.of(own_axes.T @ value, own_axes.T @ covariance_of(influence, influence) @ own_axes))
    return seen


def level(motion: Motion, known: BoolArray, forward: FloatArray, mean: Estimate) -> Estimate:
    """Find the direction, a unit vector of shape (3,), whose readings have nothing to do with those across it.

    A car accelerates along and across the road and hardly upwards, so this direction is the car's down axis, free of
    any bias. It begins with that of gravity; what is left of a tilt then shows as a share of the other readings. Crests
    and dips are told from the slope, which is what the forward reading has beyond the car's own acceleration: else
    bends on a hillside would tilt the result.
    """
    size = float(np.linalg.norm(mean.value))
    down = -np.array(mean.value) / size
    speed, block = motion.speed_mps[known], blocks_of(motion.t_s[known], LEVEL_BLOCK_S)
    weight, scatter = known.astype(np.float64), np.ones(len(speed))
    unexplained = motion.raw_mps2 - np.outer(motion.forward_mps2, forward)
    for _ in range(LEVEL_ROUNDS):
        first = forward - (forward @ down) * down
        across = np.array([first, np.cross(down, first)]) / np.linalg.norm(first)
        slope = without_slow_part(unexplained @ across[0], weight, SLOW_S) / size
        bump = motion.speed_mps * gaussian_filter1d(slope, SLOPE_S / STEP_S, order=1) / STEP_S
        causes = np.column_stack([motion.raw_mps2 @ across.T, bump])
        design, y = (without_slow_part(one, weight, SLOW_S)[known] for one in (causes, motion.raw_mps2 @ down))
        tilt = fit(design, y, block, scatter)
        scatter = sd_over_speed(tilt.residual, speed)
        weight[known] = scatter**-2
        down = down - tilt.value[:2] @ across
        down /= np.linalg.norm(down)
    covariance = tilt.covariance[:2, :2]
    return Estimate.of(down, across.T @ covariance @ across + np.trace(covariance) * np.outer(down, down))


def is_clear(column_seen: Estimate) -> bool:
    """Whether a column points anywhere."""
    return float(np.linalg.norm(column_seen.sd)) < VAGUE_RAD * float(np.linalg.norm(column_seen.value))
