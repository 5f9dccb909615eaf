"""What the gradient estimator remembers of times at which it took the charge to be elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.battery.curve import slope_at, voltage_at
from app.science.battery.gpc_kernels import GATHERED, SOON_S, GpcHistory, GpcModel
from app.science.battery.gpc_step_kernels import ALPHA, CHARGE, RELAXATION, SLOPE, X10
from app.science.battery.run import CellRecord

QUARTER = 3
"""Fewest kept rows of which a slope is made."""

ANCHORS = 64
"""Kept rows at which it is worked out; between them it is on straight lines."""


def charge_drift(record: CellRecord, out: GpcHistory, largest_a: float) -> float:
    """Return the current, A, that the counted charge seems to have too much, at most ``largest_a``.

    x₁₀ is a constant of the model. Where the current's sensor is off, the counted charge runs away, and x₁₀ runs
    against it to keep the voltage right, ever on; while it is still being found, it runs, too, but slower and slower.
    Hence the lesser slope of the last two quarters of what was learnt, if both have the same sign.
    """
    seen = np.flatnonzero(out.scalars[:, GATHERED] > 0.0)
    if len(seen) < QUARTER * 4:
        return 0.0
    quarter = len(seen) // 4
    slopes = [_slope(record, out, rows) for rows in (seen[-2 * quarter : -quarter], seen[-quarter:])]
    drift = -min(slopes, key=abs) if slopes[0] * slopes[1] > 0.0 else 0.0
    return float(np.clip(drift, -largest_a, largest_a))


def _slope(record: CellRecord, out: GpcHistory, rows: IntArray) -> float:
    t = record.t_s[record.keep[rows]]
    centred = t - t.mean()
    return float(centred @ out.theta[rows, X10] / (centred @ centred))


@dataclass(frozen=True, slots=True)
class Missed:
    """Forgotten sums of z times a voltage by which older rows miss the model, (m, N + 4) each.

    Attributes
    ----------
    stale : ndarray
        Each row was linearised at the charge of its time (eqs 62 and 63) and stays so. By the parameters of a later
        row the same charge is elsewhere, and the tangent there is off by V_oc(s) − V_oc(s_k) − C₀ (s − s_k).
    drift : ndarray
        Where the counted charge drifts, older rows were counted from elsewhere.
    """

    stale: FloatArray
    drift: FloatArray


def missed_moments(record: CellRecord, model: GpcModel, out: GpcHistory, drift_a: float) -> Missed:
    """Return what the kept rows say of it; each stands for the rows until the next one."""
    kept = record.keep
    seen = np.flatnonzero(out.scalars[:, GATHERED] > 0.0)
    stale, drift = np.zeros_like(out.cut), np.zeros_like(out.cut)
    if len(seen) < 2:
        return Missed(stale, drift)
    soc = out.theta[:, ALPHA] * (out.theta[:, X10] + out.charge)
    volts, slopes = voltage_at(model.pieces, soc), slope_at(model.pieces, soc)
    t = record.t_s[kept]
    z = np.zeros_like(out.cut)
    z[:, CHARGE], z[:, SLOPE], z[:, RELAXATION:-1] = slopes * out.charge, slopes, out.q
    z[:, -1] = record.current_a[kept] * _at(record.resistance_factor, kept)
    faded = _faded(model, t - t[seen[0]])
    z *= _weights(record, model, out)[:, None]
    anchors = np.unique(np.round(np.linspace(seen[0], seen[-1], ANCHORS)).astype(np.int64))
    for m in anchors:
        rows = seen[seen <= m]
        now = out.theta[m, ALPHA] * (out.theta[m, X10] + out.charge[rows])
        fading = np.exp(faded[rows] - faded[m])
        stale[m] = (fading * (voltage_at(model.pieces, now) - volts[rows] - slopes[rows] * (now - soc[rows]))) @ z[rows]
        drift[m] = (fading * slopes[rows] * out.theta[m, ALPHA] * drift_a * (t[rows] - t[m])) @ z[rows]
    for moments in (stale, drift):
        for column in range(moments.shape[1]):
            moments[seen, column] = np.interp(seen, anchors, moments[anchors, column])
    return Missed(stale, drift)


def lags(record: CellRecord, model: GpcModel, out: GpcHistory, values: FloatArray) -> FloatArray:
    """Return by how much values (m, …) that change steadily are told too late, (m, …).

    Rows are remembered for 1/−ln λ seconds in the mean, so that their least is as old, and the way down to it takes
    about as long again. Of the changes over the last such time and the one before it the lesser counts, and only where
    both go the same way: noise does so by chance only.
    """
    late = np.zeros_like(values)
    if model.log_forgetting == 0.0:
        return late
    t, memory_s = record.t_s[record.keep], -1.0 / model.log_forgetting
    seen = np.flatnonzero(out.scalars[:, GATHERED] > 0.0)
    rows = seen[t[seen] >= t[seen[0]] + 2.0 * memory_s] if len(seen) else seen
    for column in range(values.shape[1]):
        before, long_before = (np.interp(t[rows] - ages * memory_s, t, values[:, column]) for ages in (1.0, 2.0))
        last, one_before = values[rows, column] - before, before - long_before
        lesser = np.minimum(np.abs(last), np.abs(one_before))
        late[rows, column] = np.where(last * one_before > 0.0, 2.0 * lesser, 0.0)
    return late


def _faded(model: GpcModel, since_s: FloatArray) -> FloatArray:
    """Return the logarithm of how far the first rows have faded so long after the start."""
    steady = -model.log_forgetting
    if model.young_share == 0.0:
        return np.asarray(steady * since_s)
    turn = max(SOON_S, 1.0 / (model.young_share * steady)) if steady > 0.0 else np.inf
    first = max(steady, 1.0 / (model.young_share * SOON_S)) * np.clip(since_s, 0.0, SOON_S)
    younger = np.log(np.clip(since_s, SOON_S, turn) / SOON_S) / model.young_share
    return np.asarray(first + younger + steady * np.maximum(since_s - turn, 0.0))


def _weights(record: CellRecord, model: GpcModel, out: GpcHistory) -> FloatArray:
    """Return the time, seconds, that was gathered from each kept row to before the next."""
    lasting = np.minimum(np.diff(record.t_s, append=record.t_s[-1] + model.step_s), model.step_s)
    return np.asarray(np.add.reduceat(np.where(out.learnt, lasting, 0.0), record.keep))


def _at(factor: FloatArray, rows: IntArray) -> FloatArray:
    return factor if len(factor) == 1 else factor[rows]
