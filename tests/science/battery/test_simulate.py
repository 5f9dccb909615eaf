"""The model run forwards, against SciPy's integration of its differential equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit, Hysteresis, Warmth
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.simulate import simulate

CURVE = OpenCircuit(points=((0.0, 2.8), (0.1, 3.2), (0.5, 3.3), (0.9, 3.35), (1.0, 3.6)))
CELL = Cell(CURVE, Circuit(2.0, 0.008, 2700.0, 0.011), soc=0.6)
WARM = Warmth(reference_c=25.0, resistance_k=2000.0, relaxation_k=3500.0, capacity_per_k=0.004)


def load(rows: int, seed: int) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    t_s = np.cumsum(rng.choice([0.1, 1.0, 1.0, 7.5, 400.0], rows))
    return t_s, rng.uniform(-6.0, 4.0, rows) * (rng.uniform(size=rows) > 0.2)


def integrated(cell: Cell, t_s: FloatArray, current_a: FloatArray, temperature_c: FloatArray) -> FloatArray:
    """Integrate eq. 55, the hysteresis beside it, row by row; columns are voltage, charge, relaxation, hysteresis."""
    circuit, warmth = cell.circuit, cell.warmth or Warmth()
    hysteresis = cell.hysteresis or Hysteresis(0.0, 0.0)
    state, rows = np.array([cell.soc, 0.0, 0.0]), []
    for k, current in enumerate(current_a):
        colder = 1.0 / (temperature_c[k] + 273.15) - 1.0 / (warmth.reference_c + 273.15)
        capacity = (
            3600.0 * circuit.capacity_ah * (1.0 + warmth.capacity_per_k * (temperature_c[k] - warmth.reference_c))
        )
        series = circuit.resistance_ohm * np.exp(warmth.resistance_k * colder)
        pair = circuit.relaxation_resistance_ohm * np.exp(warmth.relaxation_k * colder)
        capacitance = circuit.time_constant_s / pair
        rest = voltage_at(cell.curve.pieces, state[:1])[0] + hysteresis.voltage_v * state[2]
        rows.append([rest + state[1] + series * current, *state])
        if k + 1 < len(t_s):

            def slope(_t: float, at: FloatArray, i: float = current, q: float = capacity) -> list[float]:
                turn = hysteresis.rate * abs(i) / q * (np.sign(i) - at[2])
                return [i / q, (i - at[1] / pair) / capacitance, turn]  # noqa: B023 - used before the loop goes on

            state = solve_ivp(slope, (t_s[k], t_s[k + 1]), state, rtol=1e-10, atol=1e-13).y[:, -1]
    return np.array(rows)


@pytest.mark.parametrize("warmth", [None, WARM])
@pytest.mark.parametrize("hysteresis", [None, Hysteresis(0.015, 60.0)])
def test_recurrences_are_exact_over_any_gap(warmth: Warmth | None, hysteresis: Hysteresis | None) -> None:
    t_s, current = load(60, 3)
    temperature = np.linspace(-10.0, 40.0, 60)
    cell = replace(CELL, warmth=warmth, hysteresis=hysteresis)
    told = simulate(cell, t_s, current, temperature)
    table = np.column_stack([told.voltage_v, told.soc, told.relaxation_v, told.hysteresis])
    np.testing.assert_allclose(table, integrated(cell, t_s, current, temperature), atol=2e-9)


def test_pack_is_its_cells() -> None:
    t_s, current = load(200, 5)
    one = simulate(CELL, t_s, current)
    pack = simulate(replace(CELL, series=96, parallel=3), t_s, 3.0 * current)
    np.testing.assert_allclose(pack.voltage_v, 96.0 * one.voltage_v, rtol=1e-13)
    np.testing.assert_allclose(pack.soc, one.soc, rtol=1e-13)
    np.testing.assert_allclose(pack.relaxation_v, one.relaxation_v, atol=1e-14)


def test_a_step_of_current_relaxes_as_the_textbook_says() -> None:
    t_s = np.arange(0.0, 301.0)
    told = simulate(CELL, t_s, np.full(301, -2.0))
    np.testing.assert_allclose(told.relaxation_v, -2.0 * 0.011 * (1.0 - np.exp(-t_s / 29.7)), rtol=1e-12, atol=1e-17)
    np.testing.assert_allclose(told.soc, 0.6 - 2.0 * t_s / 7200.0, rtol=1e-12)
    assert told.voltage_v[0] == pytest.approx(voltage_at(CURVE.pieces, np.array([0.6]))[0] - 0.016, abs=1e-12)
