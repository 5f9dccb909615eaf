"""An estimator's run over a record with holes: from hole to hole, with less certainty after each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from app.science.arrays import IntArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import BatteryConfig
from app.science.battery.estimators import ESTIMATOR_OF
from app.science.battery.pauses import Hole, across
from app.science.battery.run import Carry, CellRecord, Run
from app.science.progress import Progress, between

BY_KEPT = ("values", "sds", "bias_a", "bias_sd_a", "relaxation_v")
BY_ROW = ("residual_v", "residual_sd_v", "learnt")
SOC = 4


@dataclass(frozen=True, slots=True)
class WholeRun:
    """A run over all rows, and the state of charge it began with as it is thought of afterwards.

    Attributes
    ----------
    run : Run
        Its kept rows are ``keep``.
    keep : ndarray of int
    initial_soc, initial_soc_sd : float
    """

    run: Run
    keep: IntArray
    initial_soc: float
    initial_soc_sd: float


def run_whole(
    record: CellRecord, config: BatteryConfig, holes: Sequence[Hole], carry: Carry | None, progress: Progress
) -> WholeRun:
    """Run the configured estimator from hole to hole.

    Raises
    ------
    EstimatorDiverged
        When its numbers ran away.
    """
    n = len(record.t_s)
    bounds = [0, *(hole.before + 1 for hole in holes), n]
    runs: list[Run] = []
    keeps: list[IntArray] = []
    for k, (begin, end) in enumerate(pairwise(bounds)):
        piece = _piece(record, begin, end)
        if k:
            carry = across(runs[-1].carry, holes[k - 1], config)
        waiting = max(config.start_after_s - float(record.t_s[begin] - record.t_s[0]), 0.0)
        part = between(progress, begin / n, end / n)
        runs.append(ESTIMATOR_OF[config.estimator](piece, replace(config, start_after_s=waiting), carry, part))
        keeps.append(piece.keep + begin)
    first = _piece(record, 0, bounds[1])
    return WholeRun(_joined(runs), np.concatenate(keeps), *_first_soc(first, runs[0]))


def _piece(record: CellRecord, begin: int, end: int) -> CellRecord:
    if (begin, end) == (0, len(record.t_s)):
        return record
    inside = record.keep[(record.keep >= begin) & (record.keep < end)] - begin
    cut: dict[str, Any] = {
        field.name: column if len(column := getattr(record, field.name)) == 1 else column[begin:end]
        for field in fields(record)
        if field.name != "keep"
    }
    return CellRecord(**cut, keep=np.union1d(inside, [end - begin - 1]).astype(np.int64))


def _joined(runs: Sequence[Run]) -> Run:
    if len(runs) == 1:
        return runs[0]
    columns: dict[str, Any] = {
        name: np.concatenate([getattr(run, name) for run in runs]) for name in (*BY_KEPT, *BY_ROW)
    }
    warnings = tuple(dict.fromkeys(warning for run in runs for warning in run.warnings))
    return replace(runs[-1], **columns, warnings=warnings)


def _first_soc(piece: CellRecord, run: Run) -> tuple[float, float]:
    """Return the state of charge at the first row, counted back (MAUTC-2010-02, eq. 60), and its standard deviation.

    It is counted back from the row that leaves the least doubt: with what was found in the end of the capacity and of
    the sensor's error, whose doubts grow with the way back, from a charge whose doubt shrinks with what was learnt.
    Estimators that take the current's sensor for true count back as if it were.
    """
    bias_sd = float(run.bias_sd_a[-1]) if run.bias_a.any() else 0.0
    capacity_ah, capacity_sd = float(run.values[-1, 0]), float(run.sds[-1, 0])
    share = np.broadcast_to(piece.capacity_factor, piece.t_s.shape)[:-1]
    per_amp = np.concatenate([[0.0], np.cumsum(np.diff(piece.t_s) / (AS_PER_AH * capacity_ah * share))])[piece.keep]
    steps = np.diff(piece.t_s) * piece.current_a[:-1] / (AS_PER_AH * capacity_ah * share)
    moved = np.concatenate([[0.0], np.cumsum(steps)])[piece.keep] - run.bias_a[-1] * per_amp
    doubt = np.sqrt(run.sds[:, SOC] ** 2 + (moved * capacity_sd / capacity_ah) ** 2 + (per_amp * bias_sd) ** 2)
    best = int(np.argmin(doubt))
    return float(run.values[best, SOC] - moved[best]), float(doubt[best])
