"""The joint unscented Kalman filter over one stretch of rows, with Merwe's scaled points."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.battery.kalman.layout import (
    ALPHA,
    BETA,
    BIAS,
    KAPPA,
    LN_CAPACITANCE,
    LN_CAPACITY,
    LN_RELAXATION,
    LN_RESISTANCE,
    RELAXATION_V,
    SOC,
    STATES,
    Noise,
    Rows,
    Trace,
)
from app.science.battery.kalman.row_kernels import bound, note
from app.science.battery.kalman.steady_kernels import steadied
from app.science.jit import inline_kernel, kernel

POINTS = 2 * STATES + 1
SCALE = ALPHA * ALPHA * (STATES + KAPPA)
OUTER = 0.5 / SCALE
CENTRE_MEAN = 1.0 - STATES / SCALE
CENTRE_COVARIANCE = CENTRE_MEAN + 1.0 - ALPHA * ALPHA + BETA


@kernel
def unscented(
    rows: Rows,
    first: int,
    last: int,
    learn_from: int,
    pieces: CurvePieces,
    noise: Noise,
    mean: FloatArray,
    covariance: FloatArray,
    keep: IntArray,
    trace: Trace,
) -> None:
    """Filter rows ``first`` to ``last`` - 1, changing ``mean`` and ``covariance`` into those before row ``last``.

    Rows before ``learn_from`` are compared with their voltages, and not learnt from. The current's noise is added to
    the voltage's, and to charge and relaxation, as if these were two noises: its sign in common is left out, as it is
    wherever an unscented filter with additive noise is used (Merwe and Wan 2001).
    """
    n = len(rows.t_s)
    points = np.empty((POINTS, STATES))
    root = np.zeros((STATES, STATES))
    seen = np.empty(POINTS)
    gain = np.zeros(STATES)
    place = int(np.searchsorted(keep, first))
    steady, steady_rows = 0.0, 0.0
    factors = len(rows.resistance_factor), len(rows.relaxation_factor), len(rows.capacity_factor)
    for k in range(first, last):
        volts = rows.voltage_v[k]
        quiet, steady, steady_rows = steadied(rows.current_a[k], steady, steady_rows, noise.current_variance)
        trace.residual_v[k] = np.nan
        trace.variance_v2[k] = np.nan
        if not np.isnan(volts):
            _spread(mean, covariance, root, points)
            factor = rows.resistance_factor[k if factors[0] > 1 else 0]
            ohm = factor * np.exp(mean[LN_RESISTANCE])
            noisy = ohm * (rows.current_a[k] - quiet)
            for p in range(POINTS):
                at_rest, _slope = open_circuit(pieces, points[p, SOC])
                dropped = factor * np.exp(points[p, LN_RESISTANCE]) * (quiet - points[p, BIAS])
                seen[p] = at_rest + points[p, RELAXATION_V] + dropped + noisy
            expected = CENTRE_MEAN * seen[0]
            for p in range(1, POINTS):
                expected += OUTER * seen[p]
            variance = CENTRE_COVARIANCE * (seen[0] - expected) ** 2
            for p in range(1, POINTS):
                variance += OUTER * (seen[p] - expected) ** 2
            for j in range(STATES):
                # Outer points stand in pairs about the mean, so the centre adds nothing here.
                gain[j] = 0.0
                for p in range(1, POINTS):
                    gain[j] += OUTER * (points[p, j] - mean[j]) * (seen[p] - expected)
            explained = variance
            variance += noise.voltage_variance + ohm * ohm * noise.current_variance
            residual = volts - expected
            trace.residual_v[k] = residual
            trace.variance_v2[k] = variance
            if k >= learn_from:
                variance = max(variance, (residual / noise.gate) ** 2)
                for j in range(STATES):
                    mean[j] += gain[j] / variance * residual
                    for i in range(STATES):
                        covariance[j, i] -= gain[j] * gain[i] / variance
                if steady_rows == 1.0:
                    shrunk = ohm * ohm * noise.current_variance / (variance - explained)
                    for j in range(STATES):
                        mean[j] += shrunk * covariance[LN_RESISTANCE, j]
                bound(mean, noise)
        place = note(trace, keep, place, k, mean, covariance)
        if k + 1 == n:
            break
        _spread(mean, covariance, root, points)
        step_s = rows.t_s[k + 1] - rows.t_s[k]
        by_relaxation = rows.relaxation_factor[k if factors[1] > 1 else 0]
        by_capacity = rows.capacity_factor[k if factors[2] > 1 else 0]
        per_amp = step_s / (np.exp(mean[LN_CAPACITY]) * by_capacity)
        settled = by_relaxation * np.exp(mean[LN_RELAXATION])
        settled *= 1.0 - np.exp(-step_s * np.exp(-mean[LN_CAPACITANCE] - mean[LN_RELAXATION]))
        for p in range(POINTS):
            amps = rows.current_a[k] - points[p, BIAS]
            left = np.exp(-step_s * np.exp(-points[p, LN_CAPACITANCE] - points[p, LN_RELAXATION]))
            points[p, SOC] += amps * step_s / (np.exp(points[p, LN_CAPACITY]) * by_capacity)
            points[p, RELAXATION_V] *= left
            points[p, RELAXATION_V] += by_relaxation * np.exp(points[p, LN_RELAXATION]) * (1.0 - left) * amps
        _gather(points, mean, covariance)
        for j in range(STATES):
            covariance[j, j] += noise.walks[j] * step_s
        covariance[SOC, SOC] += per_amp * per_amp * noise.current_variance
        covariance[RELAXATION_V, RELAXATION_V] += settled * settled * noise.current_variance
        both = per_amp * settled * noise.current_variance
        covariance[SOC, RELAXATION_V] += both
        covariance[RELAXATION_V, SOC] += both


@inline_kernel
def _spread(mean: FloatArray, covariance: FloatArray, root: FloatArray, points: FloatArray) -> None:
    """Write the points of a mean and a covariance, which may be singular (Cholesky with empty columns for that)."""
    for j in range(STATES):
        pivot = covariance[j, j]
        for i in range(j):
            pivot -= root[j, i] * root[j, i]
        known = pivot <= 1e-14 * covariance[j, j]
        root[j, j] = 0.0 if known else np.sqrt(pivot)
        for row in range(j + 1, STATES):
            entry = covariance[row, j]
            for i in range(j):
                entry -= root[row, i] * root[j, i]
            root[row, j] = 0.0 if known else entry / root[j, j]
    reach = np.sqrt(SCALE)
    for j in range(STATES):
        points[0, j] = mean[j]
        for i in range(STATES):
            offset = reach * root[j, i] if i <= j else 0.0
            points[1 + i, j] = mean[j] + offset
            points[1 + STATES + i, j] = mean[j] - offset


@inline_kernel
def _gather(points: FloatArray, mean: FloatArray, covariance: FloatArray) -> None:
    """Write the mean and the covariance of moved points. Parameters and the current's error haven't moved."""
    for j in (SOC, RELAXATION_V):
        total = CENTRE_MEAN * points[0, j]
        for p in range(1, POINTS):
            total += OUTER * points[p, j]
        mean[j] = total
    for j in (SOC, RELAXATION_V):
        for i in range(STATES):
            total = CENTRE_COVARIANCE * (points[0, j] - mean[j]) * (points[0, i] - mean[i])
            for p in range(1, POINTS):
                total += OUTER * (points[p, j] - mean[j]) * (points[p, i] - mean[i])
            covariance[j, i] = covariance[i, j] = total
