"""The battery with known truth, against the model run forwards, a plain loop, and what was asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.battery.circuit import Hysteresis, Warmth
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import voltage_at
from app.science.battery.pack import cell_record
from app.science.battery.simulate import simulate
from app.science.battery.virtual.a123 import CELL, CURVE, first_guess
from app.science.battery.virtual.ageing import DEFAULT_MAP, DegradationMap, loss_at
from app.science.battery.virtual.pack import VirtualPack, virtual_pack
from app.science.errors import ScienceError

STRONG = replace(DEFAULT_MAP, loss_ah_per_ah=tuple(tuple(50.0 * x for x in row) for row in DEFAULT_MAP.loss_ah_per_ah))
BY_CHARGE = DegradationMap((0.0,), "soc", (0.2, 0.8), ((1e-4, 3e-3),))


def test_curve_is_like_an_iron_phosphate_cells() -> None:
    volts = voltage_at(CURVE.pieces, np.linspace(0.1, 0.9, 801))
    assert CURVE.falls() is None
    assert (volts[0], volts[-1]) == (pytest.approx(3.20, abs=0.002), pytest.approx(3.34, abs=0.002))
    assert np.diff(volts[100:701]).min() / 0.001 > 0.08


def test_values_are_table_7() -> None:
    told = CELL.circuit
    assert (told.capacity_ah, told.resistance_ohm) == (2.0, 0.008)
    assert (told.relaxation_capacitance_f, told.relaxation_resistance_ohm, CELL.soc) == (2700.0, 0.011, 0.7)
    guess = first_guess()
    assert (guess.cell.circuit.capacity_ah, guess.cell.circuit.resistance_ohm, guess.cell.soc) == (2.2, 0.010, 0.5)
    assert (guess.cell.circuit.relaxation_capacitance_f, guess.cell.circuit.relaxation_resistance_ohm) == (3000.0, 0.01)
    assert guess.start_after_s == 86400.0


def test_truth_is_the_model_run_forwards() -> None:
    data = virtual_pack(VirtualPack(days=0.5, current_noise_a=0.0, voltage_noise_v=0.0))
    told = simulate(CELL, data.record.t_s, data.current_a)
    np.testing.assert_array_equal(data.record.current_a, data.current_a)
    np.testing.assert_allclose(data.soc, told.soc, atol=1e-12)
    np.testing.assert_allclose(data.record.voltage_v, told.voltage_v, atol=1e-12)


def test_days_are_warm_and_cold_and_directions_differ() -> None:
    nature = replace(CELL, warmth=Warmth(25.0, 2500.0, 3500.0, 0.004), hysteresis=Hysteresis(0.015, 60.0))
    quiet = VirtualPack(1.0, cell=nature, temperature_c=(10.0, 15.0), current_noise_a=0.0, voltage_noise_v=0.0)
    data = virtual_pack(quiet)
    warm = data.record.temperature_c
    assert warm is not None
    assert (warm.min(), warm.max()) == (pytest.approx(-5.0, abs=1e-3), pytest.approx(25.0, abs=1e-3))
    told = simulate(nature, data.record.t_s, data.current_a, warm)
    np.testing.assert_allclose(data.soc, told.soc, atol=1e-12)
    np.testing.assert_allclose(data.record.voltage_v, told.voltage_v, atol=1e-12)


def test_it_is_driven_down_and_charged_up_between_the_limits() -> None:
    data = virtual_pack(VirtualPack(days=1.0))
    charging = data.current_a == 2.0
    turns = np.flatnonzero(np.diff(charging.astype(int)))
    assert len(turns) == 14
    assert np.abs(data.soc[turns[::2] + 1] - 0.2).max() < 1e-3
    assert np.abs(data.soc[turns[1::2] + 1] - 0.8).max() < 1e-3
    assert (data.soc.min(), data.soc.max()) == (pytest.approx(0.2, abs=1e-3), pytest.approx(0.8, abs=1e-3))
    assert len(data.soc) == 86401


def test_sensors_err_as_asked() -> None:
    clean, noisy = (
        virtual_pack(VirtualPack(1.0, **told))
        for told in ({"current_noise_a": 0.0, "voltage_noise_v": 0.0}, {"seed": 4, "current_bias_a": 0.02})
    )
    np.testing.assert_array_equal(clean.current_a, noisy.current_a)
    current, voltage = (noisy.record.current_a - noisy.current_a, noisy.record.voltage_v - clean.record.voltage_v)
    assert (current.mean(), current.std()) == (pytest.approx(0.02, abs=2e-4), pytest.approx(0.010, rel=0.01))
    assert (voltage.mean(), voltage.std()) == (pytest.approx(0.0, abs=4e-5), pytest.approx(0.002, rel=0.01))
    coarse = virtual_pack(VirtualPack(0.1, current_step_a=0.05, voltage_step_v=0.005)).record
    np.testing.assert_allclose(np.round(coarse.current_a / 0.05) * 0.05, coarse.current_a, atol=1e-12)
    np.testing.assert_allclose(np.round(coarse.voltage_v / 0.005) * 0.005, coarse.voltage_v, atol=1e-12)


def test_the_same_seed_gives_the_same_data() -> None:
    one, same, other = (virtual_pack(VirtualPack(0.05, seed=seed)).record for seed in (7, 7, 8))
    np.testing.assert_array_equal(one.voltage_v, same.voltage_v)
    assert (one.voltage_v != other.voltage_v).all()


def test_pack_of_many_cells_comes_back_as_one() -> None:
    quiet = VirtualPack(0.1, current_noise_a=0.0, voltage_noise_v=0.0)
    one = virtual_pack(quiet).record
    pack = virtual_pack(replace(quiet, cell=replace(CELL, series=96, parallel=4))).record
    cell = cell_record(pack, BatteryConfig(replace(CELL, series=96, parallel=4)))
    np.testing.assert_allclose(cell.voltage_v, one.voltage_v, rtol=1e-12)
    np.testing.assert_allclose(cell.current_a, one.current_a, rtol=1e-12)


@pytest.mark.parametrize("fade", [STRONG, BY_CHARGE])
def test_capacity_fades_as_the_map_says(fade: DegradationMap) -> None:
    """Every row again, one after the other, with the map looked up as arrays do it."""
    data = virtual_pack(VirtualPack(0.2, fade=fade, current_noise_a=0.0, voltage_noise_v=0.0))
    at = data.soc if fade.axis == "soc" else data.record.voltage_v
    lost = loss_at(fade, data.current_a, at) * np.abs(data.current_a) / 3600.0
    np.testing.assert_allclose(-np.diff(data.capacity_ah), lost[:-1], rtol=1e-6, atol=1e-13)
    np.testing.assert_allclose(np.diff(data.soc), data.current_a[:-1] / (3600.0 * data.capacity_ah[:-1]), atol=1e-13)
    assert data.capacity_ah[-1] < 1.999


def test_a_hundred_days_lose_some_percent() -> None:
    quarter = virtual_pack(VirtualPack(25.0, fade=DEFAULT_MAP, current_noise_a=0.0, voltage_noise_v=0.0))
    assert 4.0 * (2.0 - quarter.capacity_ah[-1]) / 2.0 == pytest.approx(0.048, abs=0.002)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"soc_range": (0.8, 0.2)}, "lowest state of charge"),
        ({"charge_a": -2.0}, "charges nothing"),
        ({"temperature_c": (60.0, 30.0)}, "where no such cell lives"),
    ],
)
def test_impossible_routines_are_refused(wrong: dict[str, object], words: str) -> None:
    with pytest.raises(ScienceError, match=words):
        virtual_pack(replace(VirtualPack(0.01), **wrong))  # type: ignore[arg-type]


def test_a_drive_downhill_is_refused() -> None:
    with pytest.raises(ScienceError, match="never comes down"):
        virtual_pack(VirtualPack(0.01), (np.arange(9.0), np.linspace(40.0, 5.0, 9)))
