"""Temperature and hysteresis through whole estimates: a battery that has them gives its circuit away all the same."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.science.battery.circuit import Hysteresis, Warmth
from app.science.battery.config import EstimatorName
from app.science.battery.estimate import estimate
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate
from app.science.battery.virtual.a123 import CELL, first_guess
from app.science.battery.virtual.pack import VirtualPack, virtual_pack

TRUTH = np.array([2.0, 0.008, 2700.0, 0.011])
WARM = Warmth(reference_c=25.0, resistance_k=2500.0, relaxation_k=3500.0, capacity_per_k=0.003)
CROOKED = Hysteresis(voltage_v=0.012, rate=60.0)
CLOSE = np.array([0.002, 0.005, 0.01, 0.01])


def measured(cut: int = 0, **nature: Any) -> tuple[BatteryRecord, float]:
    """Return three days of a battery between 3 and 27 °C without its first rows, and its last state of charge."""
    driven = virtual_pack(VirtualPack(3.0, current_noise_a=0.0, voltage_noise_v=0.0))
    t_s, rng = driven.record.t_s, np.random.default_rng(5)
    warm = 15.0 + 12.0 * np.sin(2.0 * np.pi * t_s / 86400.0)
    truth = simulate(replace(CELL, **nature), t_s, driven.current_a, warm)
    current = driven.current_a + 0.010 * rng.standard_normal(len(t_s))
    volts = truth.voltage_v + 0.002 * rng.standard_normal(len(t_s))
    return BatteryRecord(t_s[cut:], current[cut:], volts[cut:], warm[cut:]), float(truth.soc[-1])


@pytest.mark.parametrize(
    ("estimator", "nature"),
    [
        ("ekf_bias", {"warmth": WARM}),
        ("ekf_bias", {"hysteresis": CROOKED}),
        ("ekf", {"warmth": WARM, "hysteresis": CROOKED}),
        ("ukf", {"warmth": WARM, "hysteresis": CROOKED}),
    ],
)
def test_circuit_is_found_at_its_reference(estimator: EstimatorName, nature: dict[str, Any]) -> None:
    record, soc = measured(**nature)
    config = replace(first_guess(replace(CELL, **nature), start_after_s=0.0), estimator=estimator)
    found = estimate(record, config)
    assert (np.abs(found.values[:4] / TRUTH - 1.0) < CLOSE).all()
    assert found.values[4] == pytest.approx(soc, abs=0.002)


def test_where_the_hysteresis_began_is_soon_forgotten() -> None:
    """The record begins in the middle of a charge, with the whole hysteresis there, and it is thought to be none."""
    record, soc = measured(cut=9000, hysteresis=CROOKED)
    found = estimate(record, first_guess(replace(CELL, hysteresis=CROOKED), start_after_s=0.0))
    assert (np.abs(found.values[:4] / TRUTH - 1.0) < CLOSE).all()
    assert found.values[4] == pytest.approx(soc, abs=0.002)


def test_days_of_rest_do_not_turn_the_hysteresis_round() -> None:
    """The sensor shows 20 mA and noise all the while; taken for a current, that would be 5 % of the capacity a day."""
    driven = virtual_pack(VirtualPack(0.7, current_noise_a=0.0, voltage_noise_v=0.0)).current_a
    rest = np.zeros(40_000)
    current, rng = np.concatenate([driven[:30_000], rest, driven[30_000:], rest]), np.random.default_rng(3)
    t_s, cell = np.arange(float(len(current))), replace(CELL, hysteresis=CROOKED)
    truth = simulate(cell, t_s, current)
    shown = current + 0.020 + 0.010 * rng.standard_normal(len(t_s))
    record = BatteryRecord(t_s, shown, truth.voltage_v + 0.002 * rng.standard_normal(len(t_s)))
    found = estimate(record, first_guess(cell, start_after_s=0.0))
    assert found.voltage_rms_v == pytest.approx(0.002, rel=0.02)
    assert found.values[4] == pytest.approx(truth.soc[-1], abs=0.002)
    assert (np.abs(found.values[:4] / TRUTH - 1.0) < CLOSE).all()


def test_a_temperature_nobody_reckons_with_is_seen_in_the_resistance() -> None:
    """On the whole the battery is 10 K colder than its reference, so both resistances look larger."""
    record, _ = measured(warmth=WARM)
    found = estimate(record, first_guess(start_after_s=0.0))
    late = found.history["resistance_ohm"][1000:]
    assert 1.05 < late.mean() / TRUTH[1] < 1.7
    assert found.voltage_rms_v > 0.0022
