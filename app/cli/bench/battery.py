"""The Kalman estimators of batteries: speed against plain ways, closeness to known truth, and honesty about it.

The battery is the report's virtual pack, its current's sensor 20 mA off, and the estimators begin as in its Table 7
(MAUTC-2010-02, part 3). The seeds were never used for tuning.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.cli.bench.battery_cells import honesty
from app.cli.bench.dense_battery import extended_dense, unscented_filterpy
from app.cli.bench.figure import Figure, best_seconds, timed
from app.cli.output import note
from app.science.arrays import FloatArray
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.kalman.belief import first_belief
from app.science.battery.kalman.layout import PARAMETERS, STATES, Noise, Rows
from app.science.battery.kalman.running import run_ekf, run_ekf_bias, run_ukf
from app.science.battery.pack import cell_record
from app.science.battery.run import CellRecord, Estimator
from app.science.battery.virtual.a123 import GUESS
from app.science.battery.virtual.pack import VirtualData, VirtualPack, virtual_pack
from app.science.progress import silent

FRESH_SEEDS = tuple(range(9601, 9621))
BIAS_A = 0.02
DAYS, LONG_DAYS = 10.0, 100.0
HOUR_S = 3600.0
PLAIN_ROWS, POINTS_ROWS = 4000, 1000
"""So many rows are enough to time filters that take a fraction of a millisecond for one."""
ESTIMATORS: dict[str, Estimator] = {"ekf_bias": run_ekf_bias, "ekf": run_ekf, "ukf": run_ukf}
NAMES = ("capacity", "resistance", "relaxation capacitance", "relaxation resistance")
GOALS = ("below 0.2 %", "below 0.5 %", "below 1 %", "below 1 %")


@dataclass(frozen=True, slots=True)
class Found:
    """What one run came to: errors at the end, the worst of the charge after an hour, and how often it said so."""

    errors: FloatArray
    worst_soc: float
    inside: float
    voltage_v: float


def measure() -> list[Figure]:
    """Return seconds against plain filters, and for every estimator errors and coverage against the start's."""
    figures = _speeds()
    for name, estimator in ESTIMATORS.items():
        note(f"{name}: {len(FRESH_SEEDS)} times {DAYS:g} days")
        figures += _closeness(name, [_found(seed, estimator) for seed in FRESH_SEEDS])
    return figures + honesty({name: ESTIMATORS[name] for name in ("ekf_bias", "ukf")})


def _speeds() -> list[Figure]:
    note("timing")
    long = _pack(LONG_DAYS, FRESH_SEEDS[0])
    config = BatteryConfig(GUESS)
    whole = cell_record(long.record, config)
    short = _first(whole, int(DAYS * 86400.0))
    plain, points = _plain_seconds_per_row(short, config)
    figures = []
    for name, estimator in ESTIMATORS.items():
        reference, called = (points, "filterpy's unscented filter") if name == "ukf" else (plain, "dense NumPy")
        for record, days, goal in ((short, DAYS, "≤ 0.3 s"), (whole, LONG_DAYS, "≤ 3 s")):

            def work(estimator: Estimator = estimator, record: CellRecord = record) -> object:
                return estimator(record, config, None, silent)

            seconds = best_seconds(work, 3 if days == DAYS else 1)
            rows = len(record.t_s)
            figures.append(
                Figure(
                    f"{name}, {days:g} days of a row a second", seconds, "s", reference * rows,
                    f"{called}, from {PLAIN_ROWS if called == 'dense NumPy' else POINTS_ROWS} rows",
                    goal=goal if name == "ekf_bias" else "",
                )
            )  # fmt: skip
            if name == "ekf_bias":
                figures.append(
                    Figure(
                        f"{name}, {days:g} days, once more", seconds, "s", points * rows,
                        f"filterpy's unscented filter, from {POINTS_ROWS} rows",
                    )
                )  # fmt: skip
    return figures


def _plain_seconds_per_row(record: CellRecord, config: BatteryConfig) -> tuple[float, float]:
    belief = first_belief(config, None, bias=True)
    noise = Noise(4e-6, 1e-4, np.zeros(STATES), 1e9, *(belief.mean[:PARAMETERS] + far for far in (-9.0, 9.0)))
    begun = belief.mean, belief.covariance
    rows = [Rows(*(getattr(_first(record, n), name) for name in Rows._fields)) for n in (PLAIN_ROWS, POINTS_ROWS)]
    pieces = config.cell.curve.pieces
    dense = timed(lambda: extended_dense(rows[0], pieces, noise, *begun)) / PLAIN_ROWS
    points = timed(lambda: unscented_filterpy(rows[1], pieces, noise, *begun)) / POINTS_ROWS
    return dense, points


def _closeness(name: str, found: list[Found]) -> list[Figure]:
    wrong = _start_errors()
    errors = np.array([one.errors for one in found])
    goals = GOALS if name == "ekf_bias" else ("",) * 4
    figures = [
        Figure(
            f"{name}: {value}, largest of {len(found)} errors", 100.0 * float(errors[:, k].max()), "%",
            100.0 * wrong[k], "the guess it begins with", goal=goals[k],
        )
        for k, value in enumerate(NAMES)
    ]  # fmt: skip
    soc = 100.0 * max(one.worst_soc for one in found)
    figures.append(
        Figure(f"{name}: charge, largest error after the first hour", soc, "%", 20.0, "the guess it begins with",
               goal="below 1 %" if name == "ekf_bias" else "")
    )  # fmt: skip
    inside = 100.0 * float(np.mean([one.inside for one in found]))
    figures.append(
        Figure(f"{name}: truth within two standard deviations", inside, "%", 95.45, "a normal distribution", "higher",
               "90–99 %" if name == "ekf_bias" else "")
    )  # fmt: skip
    volts = 1e3 * float(np.mean([one.voltage_v for one in found]))
    figures.append(Figure(f"{name}: residual of the voltage", volts, "mV", 2.0, "the noise that was put in"))
    return figures


def _start_errors() -> FloatArray:
    data = _pack(0.01, FRESH_SEEDS[0])
    true, guess = data.cell.circuit, GUESS.circuit
    return np.array([abs(getattr(guess, name) / getattr(true, name) - 1.0) for name in VALUES[:4]])


def _found(seed: int, estimator: Estimator) -> Found:
    data = _pack(DAYS, seed)
    config = BatteryConfig(GUESS)
    record = cell_record(data.record, config)
    run = estimator(record, config, None, silent)
    circuit, keep = data.cell.circuit, record.keep
    constant = [getattr(circuit, name) for name in VALUES[1:4]]
    truth = np.column_stack([data.capacity_ah[keep], np.tile(constant, (len(keep), 1)), data.soc[keep]])
    settled = record.t_s[keep] > HOUR_S
    error = np.abs(run.values - truth)
    return Found(
        errors=error[-1] / truth[-1],
        worst_soc=float(error[settled, 4].max()),
        inside=float(np.mean(error[settled] < 2.0 * run.sds[settled])),
        voltage_v=float(np.sqrt(np.mean(run.residual_v[int(HOUR_S) :] ** 2))),
    )


def _pack(days: float, seed: int) -> VirtualData:
    return virtual_pack(VirtualPack(days, seed=seed, current_bias_a=BIAS_A))


def _first(record: CellRecord, rows: int) -> CellRecord:
    return CellRecord(
        record.t_s[:rows],
        record.current_a[:rows],
        record.voltage_v[:rows],
        record.resistance_factor,
        record.relaxation_factor,
        record.capacity_factor,
        np.append(record.keep[record.keep < rows - 1], rows - 1),
    )
