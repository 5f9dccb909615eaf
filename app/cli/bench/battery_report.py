"""The report's gPC estimator and recursive least squares on the report's case, over twenty seeds of noise.

The battery is the virtual pack of MAUTC-2010-02, part 3, with true and first values of its Table 7; the estimators are
off for the first day. The seeds were never used for tuning.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.cli.bench.figure import Figure, best_seconds, timed
from app.cli.bench.plain_gpc import written_out
from app.cli.output import note
from app.science.arrays import FloatArray
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.gpc import run_gpc
from app.science.battery.pack import cell_record
from app.science.battery.rls import run_rls
from app.science.battery.run import Run
from app.science.battery.virtual.a123 import first_guess
from app.science.battery.virtual.pack import VirtualData, VirtualPack, virtual_pack

SEEDS = tuple(range(9701, 9721))
DAYS, LONG_DAYS = 10.0, 100.0
BIAS_A = 0.005
PLAIN_ROWS = 3000
NAMES = ("capacity", "resistance", "relaxation capacitance", "relaxation resistance")
GOALS = ("below 0.2 %", "below 0.5 %", "below 1 %", "below 1 %")
CASES = (("gPC, N = 3", 3), ("gPC, N = 2", 2), ("least squares", None))


def measure() -> list[Figure]:
    """Return seconds against plain NumPy, errors against the first guess, and how honest the deviations are."""
    figures = _speeds()
    packs = [virtual_pack(VirtualPack(DAYS, seed=seed)) for seed in SEEDS]
    for name, terms in CASES:
        note(f"{name}: {len(SEEDS)} times {DAYS:g} days")
        figures += _closeness(name, [(data, _run(data, terms)) for data in packs], GOALS if terms == 3 else ("",) * 4)
    biased = virtual_pack(VirtualPack(DAYS, seed=SEEDS[0], current_bias_a=BIAS_A))
    for name, terms in (CASES[0], CASES[2]):
        error = 100.0 * abs(float(_misses(biased, _run(biased, terms))[0]))
        told = f"{name}: capacity with a current sensor {1e3 * BIAS_A:g} mA off"
        figures.append(Figure(told, error, "%", 10.0, "the guess it begins with"))
    return figures


def _speeds() -> list[Figure]:
    note("timing")
    config = _config(3)
    plain = _plain_seconds_per_row(config)
    figures = []
    for days in (DAYS, LONG_DAYS):
        record = cell_record(virtual_pack(VirtualPack(days, seed=SEEDS[0])).record, config)
        for name, work in (("gPC, N = 3", run_gpc), ("least squares", run_rls)):
            seconds = best_seconds(lambda work=work, record=record: work(record, config), 3 if days == DAYS else 1)  # type: ignore[misc]  # of this round
            reference = plain * len(record.t_s)
            figures.append(
                Figure(
                    f"{name}, {days:g} days of a row a second", seconds, "s", reference,
                    f"NumPy, equation by equation, from {PLAIN_ROWS} rows",
                )
            )  # fmt: skip
    return figures


def _plain_seconds_per_row(config: BatteryConfig) -> float:
    data = virtual_pack(VirtualPack(PLAIN_ROWS / 86_400.0, seed=SEEDS[0]))
    record = cell_record(data.record, config)
    return timed(lambda: written_out(record, config)) / len(record.t_s)


def _closeness(name: str, found: list[tuple[VirtualData, Run]], goals: tuple[str, ...]) -> list[Figure]:
    errors = np.abs(np.array([_misses(data, run) for data, run in found]))
    inside = np.mean([_inside(data, run) for data, run in found])
    guess, true = first_guess().cell.circuit, found[0][0].cell.circuit
    wrong = [abs(getattr(guess, value) / getattr(true, value) - 1.0) for value in VALUES[:4]]
    figures = [
        Figure(
            f"{name}: {value}, largest of {len(found)} errors", 100.0 * float(errors[:, k].max()), "%",
            100.0 * wrong[k], "the guess it begins with", goal=goals[k],
        )
        for k, value in enumerate(NAMES)
    ]  # fmt: skip
    told = f"{name}: truth within two standard deviations"
    return [*figures, Figure(told, 100.0 * float(inside), "%", 95.45, "a normal distribution", "higher")]


def _run(data: VirtualData, terms: int | None) -> Run:
    config = _config(terms)
    estimator = run_rls if terms is None else run_gpc
    return estimator(cell_record(data.record, config), config)


def _config(terms: int | None) -> BatteryConfig:
    config = first_guess()
    return config if terms is None else replace(config, gpc=replace(config.gpc, terms=terms))


def _misses(data: VirtualData, run: Run) -> FloatArray:
    """Return by which share the last estimates are off, (4,)."""
    truth = np.array([getattr(data.cell.circuit, value) for value in VALUES[:4]])
    return np.asarray(run.values[-1, :4] / truth - 1.0)


def _inside(data: VirtualData, run: Run) -> float:
    """Return the share of rows, from the start of learning on, with the truth inside two standard deviations."""
    rows = np.round(np.linspace(0, len(data.soc) - 1, len(run.values))).astype(np.int64)
    constant = [getattr(data.cell.circuit, value) for value in VALUES[:4]]
    truth = np.column_stack([np.tile(constant, (len(rows), 1)), data.soc[rows]])
    learnt = run.learnt[rows]
    return float(np.mean(np.abs(run.values - truth)[learnt] < 2.0 * run.sds[learnt]))
