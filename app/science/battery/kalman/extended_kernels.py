"""The joint extended Kalman filter over one stretch of rows."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.battery.kalman.layout import (
    BIAS,
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
from app.science.jit import kernel

NOISE_ONLY = 3.0
"""Currents up to so many of their standard deviations may be nothing but noise and the sensor's error."""


@kernel
def extended(
    rows: Rows,
    first: int,
    last: int,
    learn_from: int,
    pieces: CurvePieces,
    noise: Noise,
    mean: FloatArray,
    covariance: FloatArray,
    nominal: FloatArray,
    keep: IntArray,
    trace: Trace,
) -> None:
    """Filter rows ``first`` to ``last`` - 1, changing ``mean`` and ``covariance`` into those before row ``last``.

    Rows before ``learn_from`` are compared with their voltages, and not learnt from.

    With an empty ``nominal`` the model is linearised about the estimate itself (extended filter). Else about the
    trajectory that starts at ``nominal`` and follows the model without noise, which is one step of Gauss and Newton
    towards the most likely trajectory; ``nominal`` moves along.

    The current's noise of a row is in its voltage (through R) and in what it does to charge and relaxation. It is
    carried as an eighth state from the measurement to the step, after which it is over: the filter for correlated
    noises, exactly. It acts as the bias does, so it needs no derivatives of its own.
    """
    n = len(rows.t_s)
    about_itself = len(nominal) == 0
    at = mean if about_itself else nominal
    gain = np.zeros(STATES)
    with_noise = np.zeros(STATES)
    soc_with = np.zeros(STATES)
    relaxation_with = np.zeros(STATES)
    off = np.zeros(STATES)
    factors = len(rows.resistance_factor), len(rows.relaxation_factor), len(rows.capacity_factor)
    place = int(np.searchsorted(keep, first))
    steady, steady_rows = 0.0, 0.0
    for k in range(first, last):
        noise_mean, noise_variance = 0.0, noise.current_variance
        with_noise[:] = 0.0
        volts = rows.voltage_v[k]
        quiet, steady, steady_rows = steadied(rows.current_a[k], steady, steady_rows, noise.current_variance)
        trace.residual_v[k] = np.nan
        trace.variance_v2[k] = np.nan
        if not np.isnan(volts):
            ohm = np.exp(at[LN_RESISTANCE]) * rows.resistance_factor[k if factors[0] > 1 else 0]
            amps = rows.current_a[k] - at[BIAS]
            at_rest, slope = open_circuit(pieces, at[SOC])
            residual = volts - (at_rest + at[RELAXATION_V] + ohm * amps)
            # A current that may be nothing but noise tells nothing of the resistance either.
            quiet -= at[BIAS]
            least = NOISE_ONLY * NOISE_ONLY * (noise.current_variance + covariance[BIAS, BIAS])
            by_resistance = ohm * quiet if quiet * quiet > least else 0.0
            if not about_itself:
                residual -= (
                    by_resistance * (mean[LN_RESISTANCE] - at[LN_RESISTANCE])
                    + slope * (mean[SOC] - at[SOC])
                    + (mean[RELAXATION_V] - at[RELAXATION_V])
                    - ohm * (mean[BIAS] - at[BIAS])
                )
            for j in range(STATES):
                gain[j] = (
                    covariance[LN_RESISTANCE, j] * by_resistance
                    + covariance[SOC, j] * slope
                    + covariance[RELAXATION_V, j]
                    - covariance[BIAS, j] * ohm
                )
            explained = by_resistance * gain[LN_RESISTANCE] + slope * gain[SOC] + gain[RELAXATION_V] - ohm * gain[BIAS]
            variance = explained + noise.voltage_variance + ohm * ohm * noise.current_variance
            trace.residual_v[k] = residual
            trace.variance_v2[k] = variance
            if k >= learn_from:
                variance = max(variance, (residual / noise.gate) ** 2)
                inverse = 1.0 / variance
                noise_gain = -ohm * noise.current_variance * inverse
                noise_mean = noise_gain * residual
                noise_variance -= noise_gain * noise_gain * variance
                for j in range(STATES):
                    with_noise[j] = -gain[j] * noise_gain
                    share = gain[j] * inverse
                    mean[j] += share * residual
                    for i in range(STATES):
                        covariance[j, i] -= share * gain[i]
                if steady_rows == 1.0 and by_resistance != 0.0:
                    # A current that stands for itself brings its noise along, on average by so much.
                    shrunk = ohm * ohm * noise.current_variance / (variance - explained)
                    for j in range(STATES):
                        mean[j] += shrunk * covariance[LN_RESISTANCE, j]
                bound(mean, noise)
        place = note(trace, keep, place, k, mean, covariance)
        if k + 1 == n:
            break
        step_s = rows.t_s[k + 1] - rows.t_s[k]
        per_amp = step_s / (np.exp(at[LN_CAPACITY]) * rows.capacity_factor[k if factors[2] > 1 else 0])
        relaxation_ohm = np.exp(at[LN_RELAXATION]) * rows.relaxation_factor[k if factors[1] > 1 else 0]
        shares = step_s * np.exp(-at[LN_CAPACITANCE] - at[LN_RELAXATION])
        left = np.exp(-shares)
        amps = rows.current_a[k] - at[BIAS]
        settled = relaxation_ohm * (1.0 - left)
        by_capacity = -amps * per_amp
        by_capacitance = left * shares * (at[RELAXATION_V] - relaxation_ohm * amps)
        by_relaxation = by_capacitance + settled * amps
        if not about_itself:
            for j in range(STATES):
                off[j] = mean[j] - at[j]
        new_soc = at[SOC] + amps * per_amp
        new_relaxation = left * at[RELAXATION_V] + settled * amps
        if not about_itself:
            nominal[SOC], nominal[RELAXATION_V] = new_soc, new_relaxation
        mean[SOC] = new_soc + off[SOC] + by_capacity * off[LN_CAPACITY] - per_amp * (off[BIAS] + noise_mean)
        mean[RELAXATION_V] = (
            new_relaxation
            + left * off[RELAXATION_V]
            + by_capacitance * off[LN_CAPACITANCE]
            + by_relaxation * off[LN_RELAXATION]
            - settled * (off[BIAS] + noise_mean)
        )
        for j in range(STATES):
            both = covariance[BIAS, j] + with_noise[j]
            soc_with[j] = covariance[SOC, j] + by_capacity * covariance[LN_CAPACITY, j] - per_amp * both
            relaxation_with[j] = (
                left * covariance[RELAXATION_V, j]
                + by_capacitance * covariance[LN_CAPACITANCE, j]
                + by_relaxation * covariance[LN_RELAXATION, j]
                - settled * both
            )
        noise_both = with_noise[BIAS] + noise_variance
        soc_noise = with_noise[SOC] + by_capacity * with_noise[LN_CAPACITY] - per_amp * noise_both
        relaxation_noise = (
            left * with_noise[RELAXATION_V]
            + by_capacitance * with_noise[LN_CAPACITANCE]
            + by_relaxation * with_noise[LN_RELAXATION]
            - settled * noise_both
        )
        soc_variance = soc_with[SOC] + by_capacity * soc_with[LN_CAPACITY] - per_amp * (soc_with[BIAS] + soc_noise)
        between = (
            left * soc_with[RELAXATION_V]
            + by_capacitance * soc_with[LN_CAPACITANCE]
            + by_relaxation * soc_with[LN_RELAXATION]
            - settled * (soc_with[BIAS] + soc_noise)
        )
        relaxation_variance = (
            left * relaxation_with[RELAXATION_V]
            + by_capacitance * relaxation_with[LN_CAPACITANCE]
            + by_relaxation * relaxation_with[LN_RELAXATION]
            - settled * (relaxation_with[BIAS] + relaxation_noise)
        )
        for j in range(STATES):
            covariance[SOC, j] = covariance[j, SOC] = soc_with[j]
            covariance[RELAXATION_V, j] = covariance[j, RELAXATION_V] = relaxation_with[j]
        covariance[SOC, SOC] = soc_variance
        covariance[SOC, RELAXATION_V] = covariance[RELAXATION_V, SOC] = between
        covariance[RELAXATION_V, RELAXATION_V] = relaxation_variance
        for j in range(STATES):
            covariance[j, j] += noise.walks[j] * step_s
