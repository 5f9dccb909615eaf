"""A cycler's rows: what has flowed up to them, against its own counter."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.imports.battery import read_battery
from app.science.battery.circuit import Cell
from app.science.battery.laboratory import held_from_logged, tells_the_past
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate
from app.science.battery.strokes import charge_ah
from tests.science.battery.made_cells import CIRCUIT, NMC
from tests.science.battery.real_cells import leaf_record

T_S = np.array([0.0, 1.0, 61.0, 62.0, 122.0, 182.0])
LOGGED_A = np.array([0.0, -6.0, -6.0, 0.0, 0.0, 3.0])
"""A discharge from 0 to 61 s, a rest to 122 s, a charge to 182 s; each row tells what flowed before it."""


def test_charge_is_what_flowed_before_the_rows() -> None:
    volts = np.arange(6.0)
    held = held_from_logged(BatteryRecord(T_S, LOGGED_A, volts))
    at_rows = np.flatnonzero(np.isfinite(held.voltage_v))
    np.testing.assert_array_equal(held.t_s[at_rows], T_S)
    np.testing.assert_array_equal(held.current_a[at_rows], LOGGED_A)
    told = 3600.0 * charge_ah(held)[at_rows]
    np.testing.assert_allclose(told, [0.0, -6.0, -366.0, -366.0, -366.0, -186.0], atol=0.2)


def test_a_held_voltages_current_glides() -> None:
    t_s = np.arange(0.0, 600.0, 60.0)
    current = 10.0 * np.exp(-t_s / 900.0)
    held = held_from_logged(BatteryRecord(t_s, current, np.full(10, 4.2)))
    true_ah = 10.0 * 900.0 / 3600.0 * (1.0 - np.exp(-t_s / 900.0))
    np.testing.assert_allclose(charge_ah(held)[np.isfinite(held.voltage_v)], true_ah, atol=1e-3)


def test_the_counter_tells_how_rows_are_meant() -> None:
    past = np.concatenate(([0.0], np.cumsum(LOGGED_A[1:] * np.diff(T_S)))) / 3600.0
    future = np.concatenate(([0.0], np.cumsum(LOGGED_A[:-1] * np.diff(T_S)))) / 3600.0
    assert tells_the_past(T_S, LOGGED_A, past)
    assert not tells_the_past(T_S, LOGGED_A, future)
    assert not tells_the_past(T_S, LOGGED_A, np.zeros(6))


def test_a_simulated_table_with_a_counter_is_left_alone() -> None:
    rng = np.random.default_rng(3)
    t_s, current = np.arange(0.0, 60_000.0, 30.0), np.repeat(rng.normal(0.0, 3.0, 200), 10)
    counted = np.concatenate(([0.0], np.cumsum(current[:-1] * np.diff(t_s)))) / 3600.0
    volts = simulate(Cell(NMC, CIRCUIT, 0.5), t_s, current).voltage_v
    rows = "\n".join(f"{a},{b},{c},{d}" for a, b, c, d in zip(t_s, current, volts, counted, strict=True))
    record = read_battery(f"t_s,current_a,voltage_v,cap_ah\n{rows}\n".encode())
    assert len(record.t_s) == len(t_s)


@pytest.mark.parametrize("name", ["cell-low-current-hppc-25c-2", "cell-discharge-bitrode-1c"])
def test_leaf_files_are_read_as_their_counter_says(name: str, shared_data: Callable[[str], Path]) -> None:
    folder = shared_data("leaf-cell-ecm")
    record = read_battery(folder / f"{name}.csv.gz")
    assert any("count of charge" in warning for warning in record.warnings)
    assert charge_ah(record)[-1] == pytest.approx(charge_ah(leaf_record(folder, name))[-1], abs=2e-3)
