"""The estimators against known truth: how close they come, and whether they say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.battery.circuit import Cell
from app.science.battery.kalman.running import run_ekf, run_ekf_bias, run_ukf
from app.science.battery.run import Estimator
from app.science.battery.virtual.a123 import CELL, GUESS
from app.science.battery.virtual.ageing import DegradationMap
from tests.science.battery.kalman.cycled import LARGE, LARGE_GUESS, cycled

HOUR = 3600.0
ALL = [run_ekf_bias, run_ekf, run_ukf]


def test_table_7_with_a_wrong_current_sensor_over_ten_days() -> None:
    case = cycled(10.0, seed=3)
    run = run_ekf_bias(case.record, case.config)
    share = np.abs(run.values[-1] / case.truth[-1] - 1.0)
    assert share[0] < 0.002
    assert share[1] < 0.005
    assert share[2] < 0.01
    assert share[3] < 0.01
    assert run.bias_a[-1] == pytest.approx(0.02, abs=5e-4)
    assert np.nanstd(run.residual_v[int(HOUR) :]) == pytest.approx(0.002, rel=0.01)
    assert run.voltage_noise_v == pytest.approx(0.002, rel=0.02)
    settled = case.record.t_s[case.record.keep] > HOUR
    assert np.abs(run.values[settled, 4] - case.truth[settled, 4]).max() < 0.01


@pytest.mark.parametrize(("cell", "guess"), [(CELL, GUESS), (LARGE, LARGE_GUESS)])
@pytest.mark.parametrize("estimator", [run_ekf_bias, run_ukf])
def test_two_standard_deviations_hold_what_they_should(estimator: Estimator, cell: Cell, guess: Cell) -> None:
    bias = 0.02 * cell.circuit.capacity_ah / 2.0
    scores = []
    for seed in range(12):
        case = cycled(0.5, seed, cell=cell, guess=guess, bias_a=bias, current_bias_a=bias)
        scores.append(case.scores(estimator(case.record, case.config, None, lambda share: None)))
    inside = np.mean(np.abs(scores) < 2.0, axis=(0, 1))
    # Twelve seeds: a right standard deviation is missed by chance by about so much for each value, less for all.
    assert (inside > 0.8).all()
    assert 0.9 < inside.mean() < 0.99


@pytest.mark.parametrize("factors", [(1.3, 0.7, 1.3, 0.7), (0.75, 1.4, 0.7, 1.3), (1.0, 1.0, 1.0, 1.0)])
@pytest.mark.parametrize("soc", [0.4, 0.7, 0.95])
def test_where_it_begins_does_not_matter(factors: tuple[float, float, float, float], soc: float) -> None:
    case = cycled(0.3, seed=5)
    circuit = CELL.circuit
    wrong = replace(
        circuit,
        capacity_ah=circuit.capacity_ah * factors[0],
        resistance_ohm=circuit.resistance_ohm * factors[1],
        relaxation_capacitance_f=circuit.relaxation_capacitance_f * factors[2],
        relaxation_resistance_ohm=circuit.relaxation_resistance_ohm * factors[3],
    )
    run = run_ekf_bias(case.record, replace(case.config, cell=Cell(CELL.curve, wrong, soc)))
    assert (np.abs(case.scores(run)[-1]) < 3.0).all()
    assert abs(run.values[-1, 4] - case.truth[-1, 4]) < 0.01


def test_without_a_state_for_it_a_wrong_sensor_costs_accuracy_and_no_more() -> None:
    case = cycled(2.0, seed=1)
    settled = case.record.t_s[case.record.keep] > HOUR
    errors = []
    for estimator in (run_ekf, run_ekf_bias):
        run = estimator(case.record, case.config)
        errors.append(abs(run.values[-1, 0] / 2.0 - 1.0))
        assert np.abs(run.values[settled, 4] - case.truth[settled, 4]).max() < 0.03
        assert np.nanstd(run.residual_v[int(HOUR) :]) == pytest.approx(0.002, rel=0.02)
    assert errors[1] < errors[0] < 0.02
    right = cycled(2.0, seed=1, bias_a=0.0)
    assert abs(run_ekf(right.record, right.config).values[-1, 0] / 2.0 - 1.0) < 0.002


@pytest.mark.parametrize("noise_v", [0.5e-3, 6e-3])
def test_the_noise_is_told_from_the_residuals(noise_v: float) -> None:
    case = cycled(0.5, seed=2, noise_v=noise_v)
    run = run_ekf_bias(case.record, case.config)
    assert run.voltage_noise_v == pytest.approx(noise_v, rel=0.04)
    assert (np.abs(case.scores(run)[-1]) < 3.0).all()


def test_a_fading_capacity_is_followed() -> None:
    fast = DegradationMap(np.array([-9.0, 9.0]), "soc", np.array([0.0, 1.0]), np.full((2, 2), 4e-4))
    case = cycled(20.0, seed=4, fade=fast)
    run = run_ekf_bias(case.record, case.config)
    late = case.record.t_s[case.record.keep] > 3 * 86_400.0
    assert case.truth[-1, 0] < 0.93 * 2.0
    assert np.sqrt(np.mean((run.values[late, 0] / case.truth[late, 0] - 1.0) ** 2)) < 0.002
    assert np.mean(np.abs(case.scores(run)[late, 0]) < 2.0) > 0.85


@pytest.mark.parametrize("estimator", ALL)
def test_nothing_is_learnt_without_voltages_or_before_the_start(estimator: Estimator) -> None:
    case = cycled(0.1, seed=1)
    for record, config in (
        (replace(case.record, voltage_v=np.full(len(case.record.t_s), np.nan)), case.config),
        (case.record, replace(case.config, start_after_s=1e9)),
    ):
        run = estimator(record, config, None, lambda share: None)
        assert not run.learnt.any()
        np.testing.assert_allclose(run.values[-1, :4], [2.2, 0.01, 3000.0, 0.01], rtol=1e-9)
        np.testing.assert_allclose(run.sds[-1, :4] / run.values[-1, :4], [0.2, 0.5, 0.5, 0.5], rtol=1e-9)


def test_at_rest_only_the_charge_is_learnt() -> None:
    case = cycled(0.05, seed=1)
    n = len(case.record.t_s)
    rng = np.random.default_rng(0)
    at_rest = CELL.curve.coefficients
    volts = np.polynomial.Polynomial(at_rest)(0.3) + rng.normal(0.0, 2e-3, n)
    record = replace(case.record, current_a=rng.normal(0.0, 0.01, n), voltage_v=volts)
    run = run_ekf_bias(record, case.config)
    assert (run.sds[-1, :3] / run.values[-1, :3] > [0.19, 0.45, 0.4]).all()
    assert abs(run.values[-1, 4] - 0.3) < 3.0 * run.sds[-1, 4]
    assert run.sds[-1, 4] < 0.01


def test_spikes_and_missing_voltages_do_not_derail_it() -> None:
    case = cycled(1.0, seed=6)
    rng = np.random.default_rng(6)
    volts = case.record.voltage_v.copy()
    hit = rng.integers(0, len(volts), 800)
    volts[hit] += rng.choice([-1.0, -0.1, 0.1, 1.0], len(hit))
    volts[30_000:40_000] = np.nan
    run = run_ekf_bias(replace(case.record, voltage_v=volts), case.config)
    assert (np.abs(case.scores(run)[-1]) < 3.0).all()
    assert not run.learnt[hit].any()
    assert np.mean(run.learnt) > 0.87


def test_what_is_carried_over_goes_on_as_if_nothing_had_been() -> None:
    case = cycled(1.0, seed=7)
    half = len(case.record.t_s) // 2
    whole = run_ekf_bias(case.record, case.config)
    parts = [
        replace(
            case.record,
            **{name: getattr(case.record, name)[rows] for name in ("t_s", "current_a", "voltage_v")},
            keep=np.array([0, half - 1]),
        )
        for rows in (slice(0, half + 1), slice(half, None))
    ]
    parts[0] = replace(parts[0], voltage_v=np.append(parts[0].voltage_v[:-1], np.nan), keep=np.array([half]))
    first = run_ekf_bias(parts[0], case.config)
    then = run_ekf_bias(parts[1], case.config, first.carry)
    np.testing.assert_allclose(then.values[-1], whole.values[-1], rtol=2e-4)
    np.testing.assert_allclose(then.sds[-1], whole.sds[-1], rtol=0.1)


def test_a_sensor_whose_error_comes_and_goes_does_not_spoil_the_charge() -> None:
    case = cycled(1.5, seed=8, bias_a=0.0)
    swings = 0.02 * np.sin(2.0 * np.pi * case.record.t_s / 86_400.0)
    run = run_ekf_bias(replace(case.record, current_a=case.record.current_a + swings), case.config)
    settled = case.record.t_s[case.record.keep] > HOUR
    assert np.abs(run.values[settled, 4] - case.truth[settled, 4]).max() < 0.015
    assert np.mean(np.abs(case.scores(run)[settled]) < 2.0) > 0.9
    assert np.nanstd(run.residual_v[int(HOUR) :]) == pytest.approx(0.002, rel=0.02)


@pytest.mark.parametrize("estimator", ALL)
@pytest.mark.parametrize("kind", ["volts of nothing", "millivolts", "turned round", "no current", "hours for seconds"])
def test_data_that_are_not_this_batterys_leave_numbers_and_doubts(estimator: Estimator, kind: str) -> None:
    case = cycled(0.1, seed=1)
    volts, amps, t_s = case.record.voltage_v, case.record.current_a, case.record.t_s
    changed = {
        "volts of nothing": {"voltage_v": np.zeros(len(volts))},
        "millivolts": {"voltage_v": 1000.0 * volts},
        "turned round": {"current_a": -amps},
        "no current": {"current_a": np.zeros(len(amps))},
        "hours for seconds": {"t_s": 3600.0 * t_s},
    }
    run = estimator(replace(case.record, **changed[kind]), case.config, None, lambda share: None)
    assert np.isfinite(run.values).all()
    assert np.isfinite(run.sds).all()
    assert run.voltage_noise_v > 0.005
    assert (run.values[:, :4] <= 20.001 * np.array([2.2, 0.01, 3000.0, 0.01])).all()


def test_a_parameter_at_its_limit_is_told() -> None:
    case = cycled(0.2, seed=1)
    tiny = Cell(CELL.curve, replace(CELL.circuit, capacity_ah=0.05), 0.6)
    run = run_ekf_bias(case.record, replace(case.config, cell=tiny, initial_sd={"capacity_ah": 3.0}))
    assert run.values[-1, 0] <= 1.0001
    assert any("capacity stands at the limit" in warning for warning in run.warnings)


def test_contradicting_data_do_not_widen_what_little_they_say_about() -> None:
    case = cycled(2.0, seed=2)
    volts = case.record.voltage_v.copy()
    late = case.record.t_s > 1.5 * 86_400.0
    volts[late] += 0.01 * np.sin(case.record.t_s[late] / 300.0)
    run = run_ekf_bias(replace(case.record, voltage_v=volts), case.config)
    before = np.searchsorted(case.record.t_s[case.record.keep], 1.5 * 86_400.0) - 1
    assert run.sds[-1, 0] < 20.0 * run.sds[before, 0]
    assert (np.abs(case.scores(run)[-1]) < 4.0).all()
