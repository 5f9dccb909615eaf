"""One stretch of a record through a filter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import CurvePieces
from app.science.battery.kalman.belief import Belief, first_belief
from app.science.battery.kalman.extended_kernels import extended
from app.science.battery.kalman.layout import PARAMETERS, SOC, STATES, Noise, Rows, Trace
from app.science.battery.kalman.residuals import Level
from app.science.battery.kalman.unscented_kernels import unscented
from app.science.battery.run import CellRecord
from app.science.battery.sensor_noise import current_noise_a

GATE = 5.0
"""Residuals beyond so many standard deviations are hardly believed."""
VOLTAGE_NOISE_V = 2e-3
"""Of one cell's sensor, where a configuration names none."""
ITSELF = np.zeros(0)
"""No trajectory to linearise about: the estimate itself is."""
FARTHEST = float(np.log(20.0))
"""A parameter is never believed to be more than twenty times, or less than a twentieth of, what is configured."""
POINTS_LOG, POINTS_SOC = 0.15, 0.03
"""Standard deviations up to which the unscented filter does without the extended one's help."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What stays the same over all stretches of a record, and where they write.

    Attributes
    ----------
    rows, pieces, keep
        The record, the open-circuit curve, and the rows whose estimates are kept.
    learn_from : int
        First row to learn from.
    current_variance : float
        Of the noise of the current, A².
    least_v2, level
        What the voltage's noise is at least, V², and what it is taken for to begin with.
    trace, colour
        What the filters find, and by how much each row's variance was taken for larger because of coloured noise, V².
    bias, unscented : bool
        Whether the sensor's error has a state, and whether points are used.
    gaps : bool
        Whether any row is without a voltage.
    lowest, highest : ndarray (4,)
        Limits of the parameters' logarithms.
    """

    rows: Rows
    pieces: CurvePieces
    learn_from: int
    current_variance: float
    least_v2: float
    level: Level
    keep: IntArray
    trace: Trace
    colour: FloatArray
    bias: bool
    unscented: bool
    gaps: bool
    lowest: FloatArray
    highest: FloatArray


def ground_of(record: CellRecord, config: BatteryConfig, *, bias: bool, unscented: bool) -> Ground:
    """Return a record and a configuration as the filters take them, with room for what they find."""
    n, m = len(record.t_s), len(record.keep)
    start = record.t_s[0] + config.start_after_s
    volts = VOLTAGE_NOISE_V if config.voltage_noise_v is None else config.voltage_noise_v
    guess = first_belief(config, None, bias=bias).mean[:PARAMETERS]
    amps = current_noise_a(record.current_a, config)
    rows = Rows(*(np.ascontiguousarray(getattr(record, name), dtype=np.float64) for name in Rows._fields))
    trace = Trace(np.full(n, np.nan), np.full(n, np.nan), np.zeros((m, STATES)), np.zeros((m, STATES)))
    return Ground(
        rows,
        config.cell.curve.pieces,
        int(np.searchsorted(record.t_s, start)),
        amps**2,
        0.0 if config.voltage_noise_v is None else volts**2,
        Level(volts**2),
        np.ascontiguousarray(record.keep, dtype=np.int64),
        trace,
        np.zeros(n),
        bias,
        unscented,
        bool(np.isnan(rows.voltage_v).any()),
        guess - FARTHEST,
        guess + FARTHEST,
    )


def by_points(ground: Ground, before: Belief) -> bool:
    """Tell whether the unscented filter takes a stretch: not while its points would stand where no cell can be."""
    sd = np.sqrt(np.maximum(np.diag(before.covariance), 0.0))
    return bool(ground.unscented and sd[:PARAMETERS].max() < POINTS_LOG and sd[SOC] < POINTS_SOC)


def follow(
    ground: Ground, first: int, last: int, belief: Belief, level: Level, walks: FloatArray, nominal: FloatArray = ITSELF
) -> Belief:
    """Return the belief after a stretch."""
    after, nominal = belief.copy(), nominal.copy()
    gate = GATE / np.sqrt(level.colour)
    noise = Noise(level.variance_v2 * level.colour, ground.current_variance, walks, gate, ground.lowest, ground.highest)
    about = ground.rows, first, last, ground.learn_from, ground.pieces, noise
    if by_points(ground, belief):
        unscented(*about, after.mean, after.covariance, ground.keep, ground.trace)
    else:
        extended(*about, after.mean, after.covariance, nominal, ground.keep, ground.trace)
    return after
