"""The three Kalman estimators over a whole record: extended, extended with the current sensor's error, unscented."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import BatteryConfig
from app.science.battery.kalman.belief import Belief, first_belief, no_surer, told_alone
from app.science.battery.kalman.drift import seen, still
from app.science.battery.kalman.layout import BIAS, PARAMETERS, RELAXATION_V, SOC
from app.science.battery.kalman.residuals import Level
from app.science.battery.kalman.settling import CONTRADICTED, LOOK_ROWS
from app.science.battery.kalman.stretch import GATE, Ground, ground_of
from app.science.battery.kalman.uncounted import settle_uncounted
from app.science.battery.run import Carry, CellRecord, Run
from app.science.progress import Progress, silent

STRETCH_S = 6 * 3600.0
STRETCH_ROWS = 21_600
LEAST_ROWS = 500
"""A record is worked on in stretches of so much time, but of no fewer and no more rows than these."""


def run_ekf(record: CellRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent) -> Run:
    """Run the joint extended filter that takes the current sensor for true on average."""
    return _run(record, config, carry, progress, bias=False)


def run_ekf_bias(
    record: CellRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent
) -> Run:
    """Run the joint extended filter that estimates the current sensor's constant error too."""
    return _run(record, config, carry, progress, bias=True)


def run_ukf(record: CellRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent) -> Run:
    """Run the joint unscented filter, which estimates the current sensor's error too.

    While little is known, at the beginning of a cell's first record, the extended filter stands in for it: it can be
    linearised again about what was found.
    """
    return _run(record, config, carry, progress, bias=True, unscented=True)


def _run(
    record: CellRecord,
    config: BatteryConfig,
    carry: Carry | None,
    progress: Progress,
    *,
    bias: bool,
    unscented: bool = False,
) -> Run:
    ground = ground_of(record, config, bias=bias, unscented=unscented)
    belief = first_belief(config, carry, bias=bias)
    n = len(record.t_s)
    level, drift, least = ground.level, still(), np.full(PARAMETERS, np.inf)
    for first, last in stretches(record.t_s, ground.learn_from, LOOK_ROWS if unscented else STRETCH_ROWS):
        before = belief
        settled, walks = settle_uncounted(ground, config, first, last, belief, level, drift.walks)
        drift = replace(drift, walks=walks)
        if first > ground.learn_from:
            elapsed = float(record.t_s[min(last, n - 1)] - record.t_s[first])
            drift, belief = seen(drift, belief, settled.belief, elapsed)
        else:
            belief = settled.belief
        level = settled.level
        if level.colour > CONTRADICTED and last > ground.learn_from:
            least = np.minimum(least, told_alone(before, settled.belief))
            belief = no_surer(belief, least)
        ground.colour[first:last] = (level.colour - 1.0) * level.variance_v2
        progress(last / n)
    return _result(record, ground, belief, level)


def stretches(t_s: FloatArray, learn_from: int, first_rows: int = STRETCH_ROWS) -> list[tuple[int, int]]:
    """Return first rows and the rows after the last ones of stretches that cover all rows."""
    bounds = [0] if learn_from == 0 else [0, learn_from]
    n = len(t_s)
    while bounds[-1] < n:
        begin = bounds[-1]
        rows = first_rows if begin == learn_from else STRETCH_ROWS
        end = int(np.searchsorted(t_s, t_s[begin] + STRETCH_S))
        end = min(max(end, begin + LEAST_ROWS), begin + rows)
        # A last stretch too short to be judged by itself joins the one before.
        bounds.append(n if n - end < STRETCH_ROWS // 10 else end)
    return list(pairwise(bounds))


def _result(record: CellRecord, ground: Ground, belief: Belief, level: Level) -> Run:
    trace = ground.trace
    values, sds = physical(trace.means, trace.variances)
    return Run(
        values=values,
        sds=sds,
        bias_a=trace.means[:, BIAS].copy(),
        bias_sd_a=_root(trace.variances[:, BIAS]),
        relaxation_v=trace.means[:, RELAXATION_V].copy(),
        residual_v=trace.residual_v,
        residual_sd_v=_root(trace.variance_v2 - ground.colour),
        learnt=_learnt(ground),
        voltage_noise_v=float(np.sqrt(level.variance_v2)),
        warnings=_at_bounds(ground, belief),
        carry=Carry(belief.mean, belief.covariance, float(record.t_s[-1])),
    )


def _at_bounds(ground: Ground, belief: Belief) -> tuple[str, ...]:
    value = belief.mean[:PARAMETERS]
    said = []
    for k, name in enumerate(("capacity", "resistance", "relaxation capacitance", "relaxation resistance")):
        if value[k] <= ground.lowest[k] or value[k] >= ground.highest[k]:
            share = "a twentieth" if value[k] <= ground.lowest[k] else "twenty times"
            said.append(
                f"The {name} stands at the limit of what is believed, {share} of what is configured: the configuration "
                "or the data's units are not this battery's."
            )
    return tuple(said)


def physical(means: FloatArray, variances: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return values and standard deviations in the order of `VALUES`, (m, 5) each, of states (m, 7)."""
    values, sds = means[:, : SOC + 1].copy(), _root(variances[:, : SOC + 1])
    values[:, :PARAMETERS] = np.exp(values[:, :PARAMETERS])
    values[:, 0] /= AS_PER_AH
    sds[:, :PARAMETERS] *= values[:, :PARAMETERS]
    return values, sds


def _learnt(ground: Ground) -> BoolArray:
    residual = ground.trace.residual_v
    plain = np.abs(residual) <= GATE * _root(ground.trace.variance_v2 - ground.colour)
    plain[: ground.learn_from] = False
    return np.asarray(plain)


def _root(variance: FloatArray) -> FloatArray:
    return np.sqrt(np.maximum(variance, 0.0))
