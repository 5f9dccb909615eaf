"""The report's estimator against eqs 81 to 85 written out, and on its own virtual cell (MAUTC-2010-02, Table 7)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from app.cli.bench.plain_gpc import written_out
from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig, Gains, GpcSettings
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.gpc import run_gpc
from app.science.battery.pack import cell_record
from app.science.battery.run import CellRecord
from app.science.battery.virtual.a123 import first_guess
from app.science.battery.virtual.ageing import DEFAULT_MAP
from app.science.battery.virtual.pack import VirtualPack, virtual_pack
from app.science.errors import EstimatorDiverged

CURVE = OpenCircuit((3.12, 1.35, -5.4, 11.2, -11.5, 5.1, -0.42))
TRUE = Circuit(2.0, 0.008, 2700.0, 0.011)
GUESS = Circuit(2.2, 0.010, 3000.0, 0.010)
DAY = 86_400


def load(days: float, rng: np.random.Generator) -> FloatArray:
    """Return a current, A, of a 2 Ah cell that is driven from 80 to 20 % and charged with 2 A, again and again."""
    drive = np.repeat(rng.normal(-1.4, 2.0, 60), 20)
    current, soc = np.empty(round(days * DAY)), 0.7
    charging = False
    for k in range(len(current)):
        current[k] = 2.0 if charging else drive[k % len(drive)]
        soc += current[k] / TRUE.capacity_as
        charging = soc < 0.8 if charging else soc < 0.2
    return current


def record_of(current: FloatArray, rng: np.random.Generator, *, bias_a: float = 0.0) -> CellRecord:
    """Return what sensors with 10 mA and 2 mV of noise see of the report's cell, once a second."""
    charge = np.concatenate([[0.0], np.cumsum(current)[:-1]])
    kept = np.exp(-1.0 / TRUE.time_constant_s)
    relaxation = lfilter([0.0, TRUE.relaxation_resistance_ohm * (1.0 - kept)], [1.0, -kept], current)
    voltage = voltage_at(CURVE.pieces, 0.7 + charge / TRUE.capacity_as) + relaxation + TRUE.resistance_ohm * current
    n = len(current)
    return CellRecord(
        np.arange(n, dtype=np.float64),
        current + rng.normal(bias_a, 0.01, n),
        voltage + rng.normal(0.0, 0.002, n),
        *(np.ones(1) for _ in range(3)),
        np.unique(np.linspace(0, n - 1, 400).astype(np.int64)),
    )


def config(terms: int = 3, start_after_s: float = 0.0, **settings: object) -> BatteryConfig:
    return BatteryConfig(Cell(CURVE, GUESS, 0.5), "gpc", GpcSettings(terms=terms, **settings), start_after_s)  # type: ignore[arg-type]  # settings by name


@pytest.mark.parametrize("terms", [1, 2, 3, 5])
def test_the_kernel_is_the_law_written_out(terms: int) -> None:
    rng = np.random.default_rng(terms)
    record = record_of(load(0.03, rng), rng)
    told = written_out(record, setup := config(terms))[record.keep]
    values = run_gpc(record, setup).values
    np.testing.assert_allclose(values[:, 0], 1 / (3600 * told[:, 0]), rtol=1e-9)
    np.testing.assert_allclose(values[:, 1], told[:, 1], rtol=1e-9)
    np.testing.assert_allclose(values[:, 2], 1 / told[:, 2], rtol=1e-9)
    np.testing.assert_allclose(values[:, 3], told[:, 2] / (0.035 + 0.015 * told[:, 3]), rtol=1e-9)


def test_the_reports_cell_is_found_with_three_terms_and_missed_with_two() -> None:
    rng = np.random.default_rng(7)
    record = record_of(load(10.0, rng), rng)
    truth = np.array([2.0, 0.008, 2700.0, 0.011])
    three, two = (run_gpc(record, config(terms, float(DAY))) for terms in (3, 2))
    error = np.abs(three.values[-1, :4] / truth - 1.0)
    assert np.all(error < [0.002, 0.005, 0.01, 0.01])
    assert np.abs(two.values[-1, 3] / truth[3] - 1.0) > 0.02
    assert np.all(np.abs(three.values[-1, :4] - truth) < 4.0 * three.sds[-1, :4])
    assert np.all(np.abs(two.values[-1, :4] - truth) < 4.0 * two.sds[-1, :4])
    assert three.voltage_noise_v == pytest.approx(0.002, rel=0.01)
    assert np.all(three.values[record.keep < DAY, :4] == three.values[0, :4])


def test_long_ago_mistakes_are_part_of_the_deviation() -> None:
    rng = np.random.default_rng(3)
    record = record_of(load(4.0, rng), rng)
    run = run_gpc(record, config())
    late = record.keep > DAY // 2
    misses = np.abs(run.values[late, :4] - [2.0, 0.008, 2700.0, 0.011]) / run.sds[late, :4]
    assert np.all(misses < 4.0)
    assert np.mean(misses < 2.0) > 0.9


@pytest.mark.parametrize("start_after_s", [0.0, float(DAY)])
@pytest.mark.parametrize("size", [0.1, 30.0])
def test_a_cell_of_another_size_moves_by_the_same_shares(size: float, start_after_s: float) -> None:
    rng = np.random.default_rng(11)
    small = record_of(load(2.0, rng), rng)
    large = replace(small, current_a=size * small.current_a)
    guess = Circuit(size * 2.2, 0.010 / size, size * 3000.0, 0.010 / size)
    setup = config(start_after_s=start_after_s)
    same = replace(setup, cell=replace(setup.cell, circuit=guess))
    scaled = np.array([size, 1.0 / size, size, 1.0 / size, 1.0])
    np.testing.assert_allclose(run_gpc(large, same).values, scaled * run_gpc(small, setup).values, rtol=1e-6)


def test_gains_far_too_large_are_stepped_without_swinging() -> None:
    rng = np.random.default_rng(5)
    record = record_of(load(2.0, rng), rng)
    gains = Gains(2e-10, 1e-4, 1e-7, 1e-2, 1e6)
    run = run_gpc(record, config(gains=gains))
    np.testing.assert_allclose(run.values[-1, :4], [2.0, 0.008, 2700.0, 0.011], rtol=0.01)


def test_numbers_that_run_away_are_told_with_their_time() -> None:
    rng = np.random.default_rng(5)
    record = record_of(load(0.01, rng), rng)
    record.voltage_v[500] = 1e200
    with pytest.raises(EstimatorDiverged, match=r"finite at 50[01] s"):
        run_gpc(record, config())


def test_a_current_that_is_off_wrecks_it_and_is_told() -> None:
    rng = np.random.default_rng(13)
    record = record_of(load(6.0, rng), rng, bias_a=0.005)
    run = run_gpc(record, config())
    assert abs(run.values[-1, 0] / 2.0 - 1.0) > 0.01
    assert abs(run.values[-1, 0] - 2.0) < 3.0 * run.sds[-1, 0]
    assert any("runs away" in told and "ekf_bias" in told for told in run.warnings)


def test_a_rate_outside_its_range_is_told() -> None:
    rng = np.random.default_rng(17)
    record = record_of(load(1.0, rng), rng)
    run = run_gpc(record, config(sigma_range_1ps=(0.05, 0.12)))
    assert any("lowest that is looked for, 0.05 1/s" in told for told in run.warnings)


def test_rows_without_voltage_count_charge_and_teach_nothing() -> None:
    rng = np.random.default_rng(19)
    record = record_of(load(0.5, rng), rng)
    blind = np.arange(len(record.t_s)) >= 20_000
    run = run_gpc(replace(record, voltage_v=np.where(blind, np.nan, record.voltage_v)), config())
    at = np.searchsorted(record.keep, 20_000)
    np.testing.assert_array_equal(run.values[at:, :4], np.broadcast_to(run.values[at, :4], run.values[at:, :4].shape))
    charge = np.cumsum(record.current_a)[record.keep[-1] - 1] - np.cumsum(record.current_a)[record.keep[at] - 1]
    moved = run.values[-1, 4] - run.values[at, 4]
    assert moved == pytest.approx(charge / (3600 * run.values[at, 0]), rel=1e-9)
    np.testing.assert_array_equal(run.learnt, ~blind)


def test_the_next_record_goes_on_where_the_last_one_ended() -> None:
    rng = np.random.default_rng(23)
    record = record_of(load(3.0, rng), rng)
    half = len(record.t_s) // 2
    first, second = _part(record, slice(0, half)), _part(record, slice(half, None))
    before = run_gpc(first, config())
    after = run_gpc(second, config(), before.carry)
    np.testing.assert_allclose(after.values[0, :4], before.values[-1, :4], rtol=1e-3)
    charge = record.current_a[half - 1] / (3600 * before.values[-1, 0])
    assert after.values[0, 4] == pytest.approx(before.values[-1, 4] + charge, abs=1e-4)
    assert np.all(after.sds[0] < 3.0 * before.sds[-1])
    assert before.carry.covariance[6, 6] == pytest.approx(0.02**2)


def test_a_fading_capacity_is_followed_a_day_late_and_said_to_be() -> None:
    faded = virtual_pack(VirtualPack(20.0, seed=41, fade=DEFAULT_MAP))
    setup = replace(first_guess(), gpc=GpcSettings())
    record = cell_record(faded.record, setup, 400)
    run = run_gpc(record, setup)
    settled = record.t_s[record.keep] > 6 * DAY
    miss = run.values[settled, 0] - faded.capacity_ah[record.keep[settled]]
    assert faded.capacity_ah[-1] < 1.985
    assert np.all(np.abs(miss) < 0.003)
    assert np.mean(np.abs(miss) < 2.0 * run.sds[settled, 0]) > 0.9


def test_what_warmth_does_is_taken_out() -> None:
    rng = np.random.default_rng(29)
    record = record_of(load(0.2, rng), rng)
    n, factor = len(record.t_s), 1.7
    warm = replace(record, resistance_factor=np.full(n, factor), relaxation_factor=np.full(n, factor))
    plain = run_gpc(record, config()).values[0]
    told = run_gpc(warm, replace(config(), start_after_s=1e9))
    still = run_gpc(record, replace(config(), start_after_s=1e9))
    assert told.values[0] == pytest.approx(plain, rel=1e-6)
    dropped = still.residual_v - told.residual_v
    relaxation = still.relaxation_v
    assert dropped[record.keep] == pytest.approx(0.7 * (0.010 * record.current_a[record.keep] + relaxation), abs=1e-12)


def _part(record: CellRecord, rows: slice) -> CellRecord:
    n = len(record.t_s[rows])
    return replace(
        record,
        t_s=record.t_s[rows],
        current_a=record.current_a[rows],
        voltage_v=record.voltage_v[rows],
        keep=np.unique(np.linspace(0, n - 1, 100).astype(np.int64)),
    )


def test_many_short_records_are_never_surer_than_they_may_be() -> None:
    rng = np.random.default_rng(31)
    record = record_of(load(1.0, rng), rng)
    runs = [run_gpc(_part(record, slice(0, 3600)), config())]
    for hour in range(1, 24):
        runs.append(run_gpc(_part(record, slice(3600 * hour, 3600 * (hour + 1))), config(), runs[-1].carry))
    values, sds = (np.array([getattr(run, name)[-1, :4] for run in runs]) for name in ("values", "sds"))
    misses = np.abs(values - [2.0, 0.008, 2700.0, 0.011])
    assert np.mean(misses < 2.0 * sds) > 0.9
    assert misses[-1, 1] < 0.2 * misses[0, 1]
