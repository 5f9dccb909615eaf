"""Makes the report's runs: a virtual pack, the report's estimator with two and three terms, and the default one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.battery.config import ESTIMATORS, VALUES, BatteryConfig, EstimatorName
from app.science.battery.curve import voltage_at
from app.science.battery.estimators import ESTIMATOR_OF
from app.science.battery.pack import cell_record, spread
from app.science.battery.record import BatteryRecord
from app.science.battery.report import ReportRun, ReportRuns, Traces
from app.science.battery.run import Run
from app.science.battery.simulate import simulate
from app.science.battery.virtual.a123 import CELL, SECONDS_PER_DAY, first_guess
from app.science.battery.virtual.ageing import DEFAULT_MAP
from app.science.battery.virtual.current import BlendedCar, cell_current
from app.science.battery.virtual.ftp72 import ftp_72
from app.science.battery.virtual.pack import VirtualData, VirtualPack, virtual_pack
from app.science.progress import Progress, between, silent

POINTS = 600
"""Of a run's history."""

CYCLING_S = 36_000
CYCLING_STEP_S = 10
KNOWN_SOC = (0.1, 0.9)
"""Where the report takes its open-circuit curve to be known."""

PULSES_A = ((0.0, 60), (2.0, 30), (0.0, 120), (4.0, 30), (0.0, 120), (-2.0, 30), (0.0, 120), (-4.0, 30), (0.0, 180))
"""Current and seconds of each step; the report shows such a profile without its numbers."""


Wanted = Sequence[tuple[EstimatorName, int | None]]
"""Estimators, each with the terms of its expansion."""


def reproduce(
    drive_cycle: tuple[FloatArray, FloatArray] | None = None,
    progress: Progress = silent,
    *,
    days: float = 10.0,
    long_days: float = 100.0,
    seed: int = 1,
) -> ReportRuns:
    """Make the report's runs again.

    Parameters
    ----------
    drive_cycle : tuple of ndarray (m,), optional
        Time, seconds, and speed, m/s; FTP-72 when left out.
    progress : Progress
    days, long_days : float
        Of figs 30 and 31, and of fig. 33. The estimators are off for the first tenth, as in the report.
    seed : int
        Of the sensors' noise.
    """
    cycle = drive_cycle or ftp_72()
    cycling, short = _ten_hours_and_runs(cycle, days, seed, between(progress, 0.0, 0.15))
    fading = virtual_pack(VirtualPack(long_days, seed=seed, fade=DEFAULT_MAP), cycle)
    truth = _truth(fading)
    record = fading.record
    # A hundred days are hundreds of megabytes for each column: what isn't needed any more has to go.
    del fading
    runs = ReportRuns(
        curve=_curve(),
        pulses=_pulses(),
        drive=_drive(*cycle),
        cycling=cycling,
        short=short,
        degradation=DEFAULT_MAP,
        long=_runs(record, truth, (("gpc", 3), (ESTIMATORS[0], None)), between(progress, 0.2, 1.0)),
    )
    return ReportRuns.from_document(runs.document())


def _ten_hours_and_runs(
    cycle: tuple[FloatArray, FloatArray], days: float, seed: int, progress: Progress
) -> tuple[Traces, tuple[ReportRun, ...]]:
    data = virtual_pack(VirtualPack(days, seed=seed), cycle)
    wanted: Wanted = (("gpc", 2), ("gpc", 3), (ESTIMATORS[0], None))
    return _cycling(data), _runs(data.record, _truth(data), wanted, progress)


def _runs(record: BatteryRecord, truth: Traces, wanted: Wanted, progress: Progress) -> tuple[ReportRun, ...]:
    days = float(record.t_s[-1]) / SECONDS_PER_DAY
    told: list[ReportRun] = []
    for k, (estimator, terms) in enumerate(wanted):
        config = _config(estimator, terms, days)
        part = between(progress, k / len(wanted), (k + 1) / len(wanted))
        run = ESTIMATOR_OF[estimator](cell_record(record, config, POINTS), config, None, part)
        told.append(ReportRun(estimator, terms, config.start_after_s, _history(truth, run)))
    return tuple(told)


def _config(estimator: EstimatorName, terms: int | None, days: float) -> BatteryConfig:
    config = replace(first_guess(start_after_s=0.1 * days * SECONDS_PER_DAY), estimator=estimator)
    return config if terms is None else replace(config, gpc=replace(config.gpc, terms=terms))


def _truth(data: VirtualData) -> Traces:
    rows = spread(len(data.record.t_s), POINTS)
    circuit = data.cell.circuit
    constant = (circuit.resistance_ohm, circuit.relaxation_capacitance_f, circuit.relaxation_resistance_ohm)
    values = (data.capacity_ah[rows], *(np.full(len(rows), value) for value in constant), data.soc[rows])
    return Traces(data.record.t_s[rows], {f"{name}_true": values[k] for k, name in enumerate(VALUES)})


def _history(truth: Traces, run: Run) -> Traces:
    columns = dict(truth.columns)
    for k, name in enumerate(VALUES):
        columns |= {name: run.values[:, k], f"{name}_sd": run.sds[:, k]}
    rows = spread(len(run.residual_v), POINTS)
    return Traces(truth.t_s, columns | {"voltage_rms_v": _rms_between(run.residual_v, rows)})


def _rms_between(residual_v: FloatArray, rows: IntArray) -> FloatArray:
    """Return the root mean square over the rows from each kept one to the next, at the last kept row once more."""
    squares = np.add.reduceat(residual_v[:-1] ** 2, rows[:-1]) / np.diff(rows)
    return np.asarray(np.sqrt(np.append(squares, squares[-1])))


def _curve() -> Traces:
    soc = np.linspace(*KNOWN_SOC, 161)
    return Traces(np.arange(len(soc), dtype=np.float64), {"soc": soc, "voltage_v": voltage_at(CELL.curve.pieces, soc)})


def _pulses() -> Traces:
    current = np.concatenate([np.full(seconds, amperes) for amperes, seconds in PULSES_A])
    t_s = np.arange(len(current), dtype=np.float64)
    return Traces(t_s, {"current_a": current, "voltage_v": simulate(CELL, t_s, current).voltage_v})


def _drive(t_s: FloatArray, speed_mps: FloatArray) -> Traces:
    current = cell_current(BlendedCar(), t_s, speed_mps)
    seconds = t_s[0] + np.arange(len(current), dtype=np.float64)
    return Traces(seconds, {"speed_mps": np.interp(seconds, t_s, speed_mps), "current_a": current})


def _cycling(data: VirtualData) -> Traces:
    rows = slice(0, CYCLING_S + 1, CYCLING_STEP_S)
    columns = {"current_a": data.current_a[rows].copy(), "soc": data.soc[rows].copy()}
    return Traces(data.record.t_s[rows].copy(), columns)
