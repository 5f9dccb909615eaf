"""A battery's record and configuration to a judged estimate, whichever estimator does the work."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.answer import BatteryEstimate
from app.science.battery.beginning import MOST_TIMES, is_better, nearer_beginnings
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.doubts import doubts, own_noise, refuse_what_is_lost
from app.science.battery.pack import cell_record
from app.science.battery.pauses import MOST_HOLES, Hole, find_holes, words_of
from app.science.battery.preparing import Prepared, prepare
from app.science.battery.record import BatteryRecord
from app.science.battery.run import Carry, Run
from app.science.battery.whole_run import WholeRun, run_whole
from app.science.progress import Progress, between, silent

CONTRADICTED = 3.0
"""Times the voltage's own noise from which on the residuals speak against the current's sensor, too."""
POINTS = 2000
"""Rows at most in a history."""


def estimate(
    record: BatteryRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent
) -> BatteryEstimate:
    """Tell what is in a battery and what is left of it.

    Parameters
    ----------
    record : BatteryRecord
        Of the pack.
    config : BatteryConfig
        Its cell's state of charge may be NaN: it is then looked up from the first voltage, or comes with ``carry``.
    carry : Carry, optional
        What the record before left.
    progress : Progress

    Raises
    ------
    TooLittleData, SignalsError
        When the record can't tell anything.
    EstimatorDiverged
        When the estimator's numbers ran away.
    """
    prepared = prepare(record, config, carry)
    record, config = prepared.record, prepared.config
    holes = find_holes(record, config, prepared.unknown_from_s)
    whole = _begun_well(record, prepared, holes, carry, progress)
    refuse_what_is_lost(record, config, whole.run)
    rms_v = residual_rms(record, whole.run)
    doubted = doubts(record, config, prepared.response, whole.run, carry, rms_v)
    said = (*record.warnings, *words_of(record, holes), *whole.run.warnings, *doubted)
    return _answer(record, config, whole, rms_v, tuple(dict.fromkeys(said)))


def _begun_well(
    record: BatteryRecord, prepared: Prepared, holes: Sequence[Hole], carry: Carry | None, progress: Progress
) -> WholeRun:
    """Run, and again from nearer places as long as that explains the record better."""
    config, noise_v = prepared.config, own_noise(record, prepared.config, prepared.response)
    whole = _run(record, config, holes, carry, progress)
    rms_v = residual_rms(record, whole.run)
    for _ in range(MOST_TIMES if carry is None else 0):
        for nearer in nearer_beginnings(prepared.config, config, whole, rms_v > CONTRADICTED * noise_v):
            again = _run(record, nearer.config, holes, carry, progress)
            again_v = residual_rms(record, again.run)
            if is_better(nearer, whole, again, rms_v, again_v):
                config, whole, rms_v = nearer.config, again, again_v
                break
        else:
            break
    return whole


def _run(
    record: BatteryRecord, config: BatteryConfig, holes: Sequence[Hole], carry: Carry | None, progress: Progress
) -> WholeRun:
    points, share = POINTS - MOST_HOLES, 1.0 if config.cell.hysteresis is None else 0.5
    whole = run_whole(cell_record(record, config, points), config, holes, carry, between(progress, 0.0, share))
    if config.cell.hysteresis is None:
        return whole
    # The hysteresis goes with the share of the capacity that moves: with one that is 10 % off, C_r gets 2 % wrong.
    capacity_ah, bias_a = float(whole.run.values[-1, 0]), float(whole.run.bias_a[-1])
    followed = cell_record(record, config, points, capacity_ah=capacity_ah, bias_a=bias_a)
    return run_whole(followed, config, holes, carry, between(progress, share, 1.0))


def residual_rms(record: BatteryRecord, run: Run) -> float:
    """Return the root mean square of measured less predicted voltage over the rows of the second half of the time.

    Only rows that were learnt from count: what was not believed says nothing of the model. When there are none there,
    all learnt rows count.
    """
    late = run.learnt & (record.t_s >= 0.5 * (record.t_s[0] + record.t_s[-1]))
    rows = late if late.any() else run.learnt
    return float(np.sqrt(np.mean(run.residual_v[rows] ** 2))) if rows.any() else float("nan")


def _answer(
    record: BatteryRecord, config: BatteryConfig, whole: WholeRun, rms_v: float, warnings: tuple[str, ...]
) -> BatteryEstimate:
    run = whole.run
    rated = config.rated_capacity_ah or config.cell.circuit.capacity_ah
    return BatteryEstimate(
        estimator=config.estimator,
        values=run.values[-1],
        sds=run.sds[-1],
        initial_soc=whole.initial_soc,
        initial_soc_sd=whole.initial_soc_sd,
        soh=float(run.values[-1, 0] / rated),
        soh_sd=float(run.sds[-1, 0] / rated),
        rated_capacity_ah=rated,
        current_bias_a=float(run.bias_a[-1]),
        current_bias_sd_a=float(run.bias_sd_a[-1]),
        voltage_rms_v=rms_v,
        voltage_noise_v=run.voltage_noise_v,
        duration_s=float(record.t_s[-1] - record.t_s[0]),
        rows=len(record.t_s),
        rows_learnt=int(run.learnt.sum()),
        series=config.cell.series,
        parallel=config.cell.parallel,
        history=_history(record, whole, rated),
        carry=run.carry,
        started_at_utc_s=record.started_at_utc_s,
        warnings=warnings,
    )


def _history(record: BatteryRecord, whole: WholeRun, rated: float) -> dict[str, FloatArray]:
    run, keep = whole.run, whole.keep
    columns = {"t_s": record.t_s[keep]}
    for k in (4, 0, 1, 2, 3):  # the state of charge first: it is what most look for
        columns |= {VALUES[k]: run.values[:, k], f"{VALUES[k]}_sd": run.sds[:, k]}
    columns |= {"soh": run.values[:, 0] / rated, "soh_sd": run.sds[:, 0] / rated}
    columns |= {"current_bias_a": run.bias_a, "current_bias_a_sd": run.bias_sd_a, "relaxation_v": run.relaxation_v}
    columns |= {"residual_v": run.residual_v[keep], "residual_sd_v": run.residual_sd_v[keep]}
    columns |= {"current_a": record.current_a[keep], "voltage_v": record.voltage_v[keep]}
    return columns | ({} if record.temperature_c is None else {"temperature_c": record.temperature_c[keep]})
