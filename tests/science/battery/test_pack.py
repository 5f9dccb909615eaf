"""What happens to one cell of a pack, against what the model run forwards knows of that cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.battery.circuit import Cell, Circuit, Hysteresis, Warmth
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.pack import cell_record, spread, warmth_factors
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate

CELL = Cell(OpenCircuit((3.2, 0.2)), Circuit(2.0, 0.008, 2700.0, 0.011), soc=0.6, series=96, parallel=3)
T_S = np.arange(0.0, 3000.0)
CURRENT = 12.0 * np.sin(T_S / 70.0) - 3.0


def test_without_temperature_and_hysteresis_it_is_shared_out() -> None:
    record = BatteryRecord(T_S, CURRENT, simulate(CELL, T_S, CURRENT).voltage_v)
    cell = cell_record(record, BatteryConfig(CELL), points=101)
    np.testing.assert_allclose(cell.current_a, CURRENT / 3.0)
    np.testing.assert_allclose(cell.voltage_v, record.voltage_v / 96.0)
    assert [len(cell.resistance_factor), len(cell.relaxation_factor), len(cell.capacity_factor)] == [1, 1, 1]
    assert (len(cell.keep), cell.keep[0], cell.keep[-1]) == (101, 0, 2999)


def test_hysteresis_is_taken_out_of_the_voltage() -> None:
    """All but of currents within the sensor's noise, which turn it later than the model does."""
    crooked = replace(CELL, hysteresis=Hysteresis(0.02, 50.0))
    record = BatteryRecord(T_S, CURRENT, simulate(crooked, T_S, CURRENT).voltage_v)
    straight = simulate(CELL, T_S, CURRENT).voltage_v / 96.0
    assert np.abs(record.voltage_v / 96.0 - straight).max() > 0.015
    np.testing.assert_allclose(cell_record(record, BatteryConfig(crooked)).voltage_v, straight, atol=2e-4)


def test_rows_without_a_voltage_stay_without() -> None:
    volts = simulate(CELL, T_S, CURRENT).voltage_v
    volts[100:200] = np.nan
    told = cell_record(BatteryRecord(T_S, CURRENT, volts), BatteryConfig(CELL)).voltage_v
    np.testing.assert_array_equal(np.isnan(told), np.isnan(volts))


def test_factors_give_the_voltage_back() -> None:
    warm = replace(CELL, warmth=Warmth(20.0, 2500.0, 4000.0, 0.005))
    temperature = np.linspace(-5.0, 35.0, len(T_S))
    told = simulate(warm, T_S, CURRENT, temperature)
    cell = cell_record(BatteryRecord(T_S, CURRENT, told.voltage_v, temperature), BatteryConfig(warm))
    circuit = warm.circuit
    drop = circuit.resistance_ohm * cell.resistance_factor * cell.current_a
    rest = voltage_at(warm.curve.pieces, told.soc)
    np.testing.assert_allclose(cell.voltage_v, rest + told.relaxation_v + drop, rtol=1e-12)
    moved = np.diff(told.soc) * circuit.capacity_as * cell.capacity_factor[:-1]
    np.testing.assert_allclose(moved, cell.current_a[:-1], rtol=1e-9, atol=1e-10)


def test_resistance_follows_arrhenius() -> None:
    factors = warmth_factors(Warmth(25.0, 3000.0, 0.0, 0.01), np.array([25.0, 5.0, -100.0]))
    assert factors.resistance[0] == 1.0
    assert factors.resistance[1] == pytest.approx(np.exp(3000.0 * (1 / 278.15 - 1 / 298.15)))
    np.testing.assert_allclose(factors.relaxation, 1.0)
    np.testing.assert_allclose(factors.capacity, [1.0, 0.8, 0.05])


@pytest.mark.parametrize(("rows", "points", "kept"), [(1, 2000, 1), (2, 2000, 2), (5000, 2000, 2000), (10, 3, 3)])
def test_kept_rows_hold_the_first_and_the_last(rows: int, points: int, kept: int) -> None:
    keep = spread(rows, points)
    assert (len(keep), keep[0], keep[-1]) == (kept, 0, rows - 1)
    assert rows == 1 or (np.diff(keep) > 0).all()
