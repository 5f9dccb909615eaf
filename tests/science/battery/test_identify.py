"""Identification against known truth, finite differences, and real cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit
from app.science.battery.identify import identify
from app.science.battery.identify_descent import rows_together
from app.science.battery.identify_kernels import sensitive_voltage
from app.science.battery.open_circuit_fit import fit_curve
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate
from app.science.battery.simulate_kernels import RowFactors
from tests.science.battery.made_cells import CIRCUIT, LFP, NMC, pulsed
from tests.science.battery.real_cells import leaf_record

TRUE = np.array([5.0, 0.02, 2000.0, 0.015, 1.0])


def wrong(curve: OpenCircuit, soc: float = 0.8) -> BatteryConfig:
    """Return a configuration that is wrong in everything."""
    return BatteryConfig(Cell(curve, Circuit(6.0, 0.03, 700.0, 0.03), soc))


def test_voltage_is_the_simulators_and_its_derivatives_are_differences() -> None:
    rng = np.random.default_rng(4)
    t_s = np.cumsum(rng.uniform(0.5, 20.0, 300))
    current = rng.normal(0.0, 3.0, 300)
    factors = RowFactors(rng.uniform(0.8, 1.2, 300), rng.uniform(0.8, 1.2, 300), rng.uniform(0.9, 1.1, 300))
    at = np.array([np.log(5.0 * 3600.0), np.log(0.02), np.log(2000.0), np.log(0.015), 0.6, 0.01, 0.05])

    def told(unknowns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        voltage, slopes, _, last = sensitive_voltage(NMC.pieces, factors, unknowns, t_s, current)
        return np.append(voltage, last[:, 0]), np.vstack([slopes, last[:, 1:]])

    slopes = told(at)[1]
    for k in range(7):
        step = np.zeros(7)
        step[k] = 1e-6
        np.testing.assert_allclose(slopes[:, k], (told(at + step)[0] - told(at - step)[0]) / 2e-6, rtol=1e-4, atol=1e-6)

    one = np.ones(1)
    plain = at.copy()
    plain[5:] = 0.0
    voltage = sensitive_voltage(NMC.pieces, RowFactors(one, one, one), plain, t_s, current)[0]
    np.testing.assert_allclose(voltage, simulate(Cell(NMC, CIRCUIT, 0.6), t_s, current).voltage_v, rtol=1e-13)


@pytest.mark.parametrize("curve", [NMC, LFP], ids=["nmc", "lfp"])
def test_truth_is_found_from_a_wrong_start(curve: OpenCircuit) -> None:
    found = identify(pulsed(curve), wrong(curve))
    np.testing.assert_allclose(found.values[:4], TRUE[:4], rtol=0.01)
    assert found.values[4] == pytest.approx(1.0, abs=2e-3)
    assert found.voltage_rms_v == pytest.approx(1e-3, rel=0.05)
    assert found.rows_together == pytest.approx(1.0, abs=0.2)
    assert found.converged
    assert found.warnings == ()


def test_standard_deviations_cover_the_truth() -> None:
    away = np.array([_away(seed) for seed in range(20)])
    assert 0.9 <= (np.abs(away) < 2.0).mean() <= 0.99


def _away(seed: int) -> np.ndarray:
    record = pulsed(NMC, seed=seed, noise_v=2e-3)
    few = slice(None, 12_000)
    part = BatteryRecord(record.t_s[few], record.current_a[few], record.voltage_v[few])
    found = identify(part, wrong(NMC))
    return np.asarray((found.values - TRUE) / found.sds)


def test_a_pack_with_a_biased_sensor() -> None:
    one = pulsed(NMC)
    pack = replace(one, current_a=3.0 * (one.current_a + 0.02), voltage_v=96.0 * one.voltage_v)
    config = wrong(NMC)
    found = identify(pack, replace(config, cell=replace(config.cell, series=96, parallel=3)))
    assert found.bias_a == pytest.approx(0.02, abs=2e-3)
    np.testing.assert_allclose(found.values[:4], TRUE[:4], rtol=0.01)


def test_what_the_data_do_not_tell_is_said() -> None:
    rng = np.random.default_rng(0)
    t_s, still = np.arange(600.0), np.zeros(600)
    told = simulate(Cell(NMC, CIRCUIT, 0.5), t_s, still).voltage_v + 1e-3 * rng.standard_normal(600)
    found = identify(BatteryRecord(t_s, still, told), wrong(NMC))
    assert sum("say little" in warning for warning in found.warnings) == 4
    assert found.sds[4] < 0.01


def test_carried_knowledge_goes_on_where_the_record_ends() -> None:
    record = pulsed(NMC)
    first, second = slice(None, 20_000), slice(20_000, None)
    begun = identify(BatteryRecord(record.t_s[first], record.current_a[first], record.voltage_v[first]), wrong(NMC))
    rest = BatteryRecord(record.t_s[second], record.current_a[second], record.voltage_v[second])
    ended = identify(rest, wrong(NMC), begun.carry)
    whole = identify(record, wrong(NMC))
    np.testing.assert_allclose(ended.values[:4], whole.values[:4], rtol=3e-3)
    assert (ended.sds[:4] <= 1.05 * begun.sds[:4]).all()


def test_rows_that_hang_together() -> None:
    rng = np.random.default_rng(1)
    white = rng.standard_normal(20_000)
    coloured = np.empty_like(white)
    level = 0.0
    for row, kick in enumerate(white):
        level = 0.9 * level + kick
        coloured[row] = level
    assert rows_together(white) == pytest.approx(1.0, abs=0.1)
    assert rows_together(coloured) == pytest.approx((1 + 0.9) / (1 - 0.9), rel=0.2)


@pytest.mark.parametrize(
    ("name", "resistance_ohm"),
    [
        ("cell-low-current-hppc-10c", 2.9e-3),
        ("cell-low-current-hppc-25c-2", 1.8e-3),
        ("cell-low-current-hppc-40c-1", 1.6e-3),
    ],
)
def test_leaf_pulses_tell_capacity_and_resistance(
    name: str, resistance_ohm: float, shared_data: Callable[[str], Path]
) -> None:
    """The resistance is what the first half second of a 30 A pulse tells, (V before - V after) / 30 A, mid-charge."""
    record = leaf_record(shared_data("leaf-cell-ecm"), name)
    fitted = fit_curve(record)
    found = identify(record, BatteryConfig(Cell(fitted.curve, Circuit(33.1, 0.002, 2e4, 0.002), 0.1)))
    assert 30.0 <= found.values[0] <= 31.2
    assert found.values[1] == pytest.approx(resistance_ohm, rel=0.12)
    assert 40.0 < found.circuit.time_constant_s < 150.0
    assert any("hangs together" in warning for warning in found.warnings)
