"""Open-circuit curves found again in slow charges and discharges, and read off real cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.open_circuit_fit import fit_curve
from app.science.battery.record import BatteryRecord
from app.science.errors import ScienceError, TooLittleData
from tests.science.battery.made_cells import CIRCUIT, LFP, NMC, cycled, measured, pulsed
from tests.science.battery.real_cells import leaf_record

INSIDE = np.linspace(0.08, 0.95, 88)


@pytest.mark.parametrize("curve", [NMC, LFP], ids=["nmc", "lfp"])
def test_slow_charge_and_discharge_average_to_the_curve(curve: OpenCircuit) -> None:
    fitted = fit_curve(cycled(curve, 0.1))
    np.testing.assert_allclose(voltage_at(fitted.curve.pieces, INSIDE), voltage_at(curve.pieces, INSIDE), atol=3e-3)
    assert fitted.capacity_ah == pytest.approx(5.0, rel=2e-3)
    spread = np.nanmedian(fitted.spread_v[10:-10])
    total = CIRCUIT.resistance_ohm + CIRCUIT.relaxation_resistance_ohm
    assert spread == pytest.approx(2.0 * 0.5 * total, rel=0.1)
    assert len(fitted.soc) <= 60
    assert fitted.warnings == ()


def test_pulses_with_rests_give_curve_and_resistance() -> None:
    fitted = fit_curve(pulsed(NMC), capacity_ah=5.0)
    np.testing.assert_allclose(voltage_at(fitted.curve.pieces, INSIDE), voltage_at(NMC.pieces, INSIDE), atol=4e-3)
    np.testing.assert_allclose(fitted.resistance_ohm[15:-10], 0.035, rtol=0.15)
    assert "while discharging only" in fitted.warnings[0]


def test_a_pack_is_fitted_as_one_of_its_cells() -> None:
    one = cycled(NMC, 0.1)
    pack = replace(one, current_a=3.0 * one.current_a, voltage_v=96.0 * one.voltage_v)
    np.testing.assert_allclose(fit_curve(pack, series=96, parallel=3).volts, fit_curve(one).volts, atol=1e-6)


def test_separate_records_are_taken_together() -> None:
    whole = cycled(NMC, 0.1)
    half = len(whole.t_s) // 2
    parts = [
        replace(whole, t_s=whole.t_s[rows], current_a=whole.current_a[rows], voltage_v=whole.voltage_v[rows])
        for rows in (slice(None, half), slice(half, None))
    ]
    told = voltage_at(fit_curve(parts).curve.pieces, INSIDE)
    np.testing.assert_allclose(told, voltage_at(NMC.pieces, INSIDE), atol=3e-3)


def test_fast_data_and_a_covered_part_are_said() -> None:
    fast = fit_curve(cycled(NMC, 1.0))
    assert any("per hour" in warning for warning in fast.warnings)
    whole = cycled(NMC, 0.1)
    part = replace(whole, t_s=whole.t_s[:2500], current_a=whole.current_a[:2500], voltage_v=whole.voltage_v[:2500])
    fitted = fit_curve(part, capacity_ah=5.0, limits_v=(3.0, 4.19))
    assert fitted.curve.soc_range[0] == pytest.approx(1.0 - 2440 / 3600, abs=0.03)
    assert any("known there only" in warning for warning in fitted.warnings)


def test_without_an_end_or_a_capacity_it_says_what_is_missing() -> None:
    whole = cycled(NMC, 0.1)
    part = replace(whole, t_s=whole.t_s[:2500], current_a=whole.current_a[:2500], voltage_v=whole.voltage_v[:2500])
    with pytest.raises(TooLittleData, match="Give the capacity"):
        fit_curve(part, limits_v=(3.0, 4.19))
    with pytest.raises(TooLittleData, match="reach neither"):
        fit_curve(part, capacity_ah=5.0, limits_v=(2.5, 4.5))


def test_ends_may_stand_for_other_states_of_charge() -> None:
    lasts = int(0.8 * 36_000 / 10)
    flows = np.concatenate([np.zeros(30), np.full(lasts, 0.5), np.zeros(360), np.full(lasts, -0.5), np.zeros(30)])
    record = measured(LFP, 10.0 * np.arange(len(flows)), flows, 0.1, 0, 1e-3)
    fitted = fit_curve(record, ends_soc=(0.1, 0.9))
    inside = np.linspace(0.12, 0.88, 77)
    np.testing.assert_allclose(voltage_at(fitted.curve.pieces, inside), voltage_at(LFP.pieces, inside), atol=3e-3)
    assert fitted.capacity_ah == pytest.approx(5.0, rel=5e-3)
    assert any("80% of the capacity given" in one for one in fit_curve(record, capacity_ah=5.0).warnings)


@pytest.mark.parametrize(
    ("current", "volts", "words"),
    [
        (-cycled(NMC, 0.5).current_a, cycled(NMC, 0.5).voltage_v, "sign seems to be swapped"),
        (cycled(NMC, 0.5).current_a, 96.0 * cycled(NMC, 0.5).voltage_v, "stand in series"),
        (np.zeros(50), np.full(50, 3.7), "0 Ah flow"),
        (np.ones(50), np.full(50, np.nan), "0 rows have a voltage"),
        (np.full(50, -1.0), np.full(50, 3.7), "seems to be frozen"),
    ],
)
def test_what_shows_no_curve_is_refused(current: FloatArray, volts: FloatArray, words: str) -> None:
    with pytest.raises(ScienceError, match=words):
        fit_curve(BatteryRecord(10.0 * np.arange(len(current)), current, volts))
    with pytest.raises(TooLittleData, match="no data"):
        fit_curve([])


def test_a_fast_discharge_that_ends_early_is_not_empty(shared_data: Callable[[str], Path]) -> None:
    """At 1 C the Leaf's cell gives 30.3 Ah down to 3 V, at 3 C 28.5: the rest is still in it."""
    folder = shared_data("leaf-cell-ecm")
    slow, fast = (leaf_record(folder, f"cell-discharge-bitrode-{rate}c") for rate in (1, 3))
    alone, both = fit_curve(slow), fit_curve([slow, fast])
    assert both.capacity_ah == pytest.approx(alone.capacity_ah, rel=1e-3)
    told = [voltage_at(one.curve.pieces, INSIDE[7:]) for one in (alone, both)]
    np.testing.assert_allclose(told[1], told[0], atol=0.015)


def test_curves_of_one_leaf_cell_agree_across_temperatures(shared_data: Callable[[str], Path]) -> None:
    folder = shared_data("leaf-cell-ecm")
    names = ("cell-low-current-hppc-10c", "cell-low-current-hppc-25c-2", "cell-low-current-hppc-40c-1")
    told = [voltage_at(fit_curve(leaf_record(folder, name)).curve.pieces, INSIDE[7:]) for name in names]
    assert np.ptp(told, axis=0).max() < 0.012
    fast = fit_curve(leaf_record(folder, "cell-discharge-bitrode-1c"))
    np.testing.assert_allclose(voltage_at(fast.curve.pieces, INSIDE[12:]), told[1][5:], atol=0.025)
