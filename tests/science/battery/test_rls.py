"""Recursive least squares against the closed solution of the same normal equations, and on a cell that is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.signal import lfilter

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.rls import run_rls
from app.science.battery.run import CellRecord

CURVE = OpenCircuit(points=((0.0, 3.0), (0.1, 3.45), (0.3, 3.61), (0.5, 3.71), (0.7, 3.9), (0.9, 4.08), (1.0, 4.19)))
TRUTH = np.array([5.0, 0.004, 6000.0, 0.005])
GUESS = BatteryConfig(Cell(CURVE, Circuit(4.3, 0.006, 4500.0, 0.007), 0.4))


def voltage_of(current: FloatArray, capacity_ah: float, r: float, c_r: float, r_r: float, soc: float) -> FloatArray:
    charge = np.concatenate([[0.0], np.cumsum(current)[:-1]])
    kept = np.exp(-1.0 / (r_r * c_r))
    relaxation = lfilter([0.0, r_r * (1.0 - kept)], [1.0, -kept], current)
    return voltage_at(CURVE.pieces, soc + charge / (3600.0 * capacity_ah)) + relaxation + r * current


def made(hours: float, seed: int, noise_v: float = 0.001) -> CellRecord:
    """Return a cell that is discharged in steps of a few seconds from 60 %, then charged, without current noise."""
    rng = np.random.default_rng(seed)
    n = round(3600 * hours)
    current = np.repeat(rng.normal(-2.0, 5.0, n // 7 + 1), 7)[:n]
    current[n // 2 :] += 4.0
    return CellRecord(
        np.arange(n, dtype=np.float64),
        current,
        voltage_of(current, *TRUTH, 0.6) + rng.normal(0.0, noise_v, n),
        *(np.ones(1) for _ in range(3)),
        np.unique(np.linspace(0, n - 1, 200).astype(np.int64)),
    )


@pytest.mark.parametrize("seed", range(3))
def test_a_cell_is_found_within_hours_as_by_fitting_everything_at_once(seed: int) -> None:
    record = made(4.0, seed)
    run = run_rls(record, GUESS)

    def missed(logs: FloatArray) -> FloatArray:
        return voltage_of(record.current_a, *np.exp(logs[:4]), logs[4]) - record.voltage_v

    peer = least_squares(missed, [*np.log(TRUTH), 0.6], x_scale="jac")
    np.testing.assert_allclose(run.values[-1, :4], np.exp(peer.x[:4]), rtol=0.01)
    assert np.all(np.abs(run.values[-1, :4] - TRUTH) < 4.0 * run.sds[-1, :4])
    soc = 0.6 + np.sum(record.current_a[:-1]) / (3600.0 * TRUTH[0])
    assert run.values[-1, 4] == pytest.approx(soc, abs=2e-3)
    assert run.voltage_noise_v == pytest.approx(0.001, rel=0.15)


def test_without_a_current_nothing_but_the_charge_is_known() -> None:
    record = made(1.0, 1)
    idle = replace(record, current_a=np.zeros(len(record.t_s)), voltage_v=voltage_at(CURVE.pieces, np.full(3600, 0.6)))
    run = run_rls(idle, GUESS)
    circuit = GUESS.cell.circuit
    guess = [circuit.capacity_ah, circuit.resistance_ohm, circuit.relaxation_capacitance_f]
    np.testing.assert_allclose(run.values[-1, :3], guess, rtol=1e-3)
    assert np.all(run.sds[-1, :4] > 0.15 * run.values[-1, :4])
    assert run.values[-1, 4] == pytest.approx(0.6, abs=2e-3)


def test_a_start_later_on_leaves_the_parameters_alone_until_then() -> None:
    record = made(1.0, 2)
    run = run_rls(record, replace(GUESS, start_after_s=1800.0))
    early = record.keep < 1800
    assert np.all(run.values[early, :4] == run.values[0, :4])
    assert not run.learnt[:1800].any()
    assert run.learnt[1800:].all()


def test_the_next_record_begins_with_what_is_known() -> None:
    first, second = made(4.0, 3), made(0.05, 4)
    before = run_rls(first, GUESS)
    mean = before.carry.mean.copy()
    mean[4], mean[5] = 0.6, 0.0
    after = run_rls(second, GUESS, replace(before.carry, mean=mean))
    np.testing.assert_allclose(after.values[-1, :4], before.values[-1, :4], rtol=0.02)
    assert np.all(after.sds[-1, :4] < 2.0 * before.sds[-1, :4])
