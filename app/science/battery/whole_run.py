"""An estimator's run over a record with holes: from hole to hole, with less certainty after each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from app.science.arrays import IntArray
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
    """Return the state of charge at the first row, counted back from the last one (MAUTC-2010-02, eq. 60)."""
    capacity_ah, soc = run.values[-1, 0], run.values[-1, SOC]
    step = np.diff(piece.t_s)
    per_as = step / (3600.0 * capacity_ah * np.broadcast_to(piece.capacity_factor, piece.t_s.shape)[:-1])
    moved = float(np.sum((piece.current_a[:-1] - run.bias_a[-1]) * per_as))
    by_capacity = moved * run.sds[-1, 0] / capacity_ah
    by_bias = float(np.sum(per_as)) * run.bias_sd_a[-1]
    return float(soc - moved), float(np.sqrt(run.sds[-1, SOC] ** 2 + by_capacity**2 + by_bias**2))
