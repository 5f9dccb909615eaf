"""A cell of tables: the plain circuit where nothing varies, the differential equation where everything does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import RegularGridInterpolator

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.simulate import simulate
from app.science.battery.virtual.tables import TableCell, simulate_tables
from tests.science.battery.pybamm_cell import pybamm_cell

CURVE = OpenCircuit((3.4, 0.5))
T_S = np.cumsum(np.random.default_rng(2).choice([1.0, 5.0, 60.0], 80))
CURRENT = np.random.default_rng(3).uniform(-150.0, 100.0, 80)


def constant(value: float) -> FloatArray:
    return np.full((2, 2, 2), value)


def test_constant_tables_are_the_plain_circuit() -> None:
    axes = (np.array([0.0, 40.0]), np.array([-200.0, 200.0]), np.array([0.0, 1.0]))
    cell = TableCell(CURVE, 100.0, *axes, constant(4e-4), constant(6e-4), constant(5e4))
    told = simulate_tables(cell, T_S, CURRENT, 25.0, 0.6)
    plain = simulate(Cell(CURVE, Circuit(100.0, 4e-4, 5e4, 6e-4), 0.6), T_S, CURRENT)
    np.testing.assert_allclose(told.simulated.voltage_v, plain.voltage_v, rtol=1e-12)
    np.testing.assert_allclose(told.simulated.soc, plain.soc, rtol=1e-12)
    np.testing.assert_allclose(told.simulated.relaxation_v, plain.relaxation_v, atol=1e-13)


def test_published_cell_is_what_its_authors_say(shared_data: Callable[[str], Path]) -> None:
    """At 25 °C, half full and 100 A the whole resistance is 1 mΩ, two fifths of it in series, and τ is 30 s."""
    cell = pybamm_cell(shared_data("pybamm-ecm-tables"))
    told = simulate_tables(cell, np.array([0.0, 1.0]), np.full(2, -100.0), 25.0, 0.5)
    assert told.resistance_ohm[0] + told.relaxation_resistance_ohm[0] == pytest.approx(1e-3, rel=0.02)
    assert told.resistance_ohm[0] / told.relaxation_resistance_ohm[0] == pytest.approx(2.0 / 3.0, rel=1e-6)
    assert (told.relaxation_resistance_ohm * told.relaxation_capacitance_f)[0] == pytest.approx(30.0, rel=0.02)


def test_published_cell_follows_its_differential_equation(shared_data: Callable[[str], Path]) -> None:
    """Within a step the tables move a little with the charge, so the steps are short."""
    cell = pybamm_cell(shared_data("pybamm-ecm-tables"))
    t_s, temperature = np.arange(0.0, 240.0), 10.0
    current = np.where(t_s < 120.0, -180.0, 90.0)
    told = simulate_tables(cell, t_s, current, temperature, 0.55)
    axes = (cell.temperature_c, cell.current_a, cell.soc)
    series, pair, capacitance = (
        RegularGridInterpolator(axes, table)
        for table in (cell.resistance_ohm, cell.relaxation_resistance_ohm, cell.relaxation_capacitance_f)
    )

    def slope(t: float, at: FloatArray) -> list[float]:
        i = -180.0 if t < 120.0 else 90.0
        where = [temperature, i, at[0]]
        return [i / 360000.0, (i - at[1] / pair(where)[0]) / capacitance(where)[0]]

    peer = solve_ivp(slope, (0.0, 239.0), [0.55, 0.0], t_eval=t_s, max_step=1.0, rtol=1e-8, atol=1e-10).y
    drop = series(np.column_stack([np.full(240, temperature), current, peer[0]])) * current
    volts = voltage_at(cell.curve.pieces, peer[0]) + peer[1] + drop
    np.testing.assert_allclose(told.simulated.voltage_v, volts, atol=5e-5)
