"""The noise of a current's sensor, found again in data whose noise is known, and what it does to the charge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.battery.circuit import Circuit
from app.science.battery.estimate import estimate
from app.science.battery.sensor_noise import current_noise_a
from app.science.battery.virtual.a123 import CELL, first_guess
from app.science.battery.virtual.pack import pack_of, virtual_pack

LARGE = replace(CELL, circuit=Circuit(60.0, 0.0004, 60000.0, 0.0005))


@pytest.mark.parametrize("noise_a", [0.05, 0.15, 0.4])
def test_noise_is_found_where_the_battery_is_charged(noise_a: float) -> None:
    data = virtual_pack(replace(pack_of(LARGE, 1.0), current_noise_a=noise_a))
    assert current_noise_a(data.record.current_a, first_guess(LARGE)) == pytest.approx(noise_a, rel=0.1)


def test_what_is_stated_holds() -> None:
    stated = replace(first_guess(), current_noise_a=0.003)
    assert current_noise_a(np.random.default_rng(1).normal(size=1000), stated) == 0.003


@pytest.mark.parametrize(
    ("current_a", "told"),
    [
        (np.zeros(1000), 0.01),
        (np.ones(3), 0.01),
        (np.random.default_rng(2).uniform(-6.0, 6.0, 5000), 0.02),
    ],
)
def test_silence_and_unrest_are_not_believed(current_a: np.ndarray, told: float) -> None:
    assert current_noise_a(current_a, first_guess()) == pytest.approx(told)


def test_the_charge_of_a_large_cell_is_as_sure_as_its_sensor_allows() -> None:
    inside = []
    for seed in range(4):
        pack = replace(pack_of(LARGE, 0.5), seed=seed, current_noise_a=0.3, current_bias_a=0.3)
        data = virtual_pack(replace(pack, voltage_noise_v=0.001))
        found = estimate(data.record, first_guess(LARGE, start_after_s=0.0))
        rows = np.searchsorted(data.record.t_s, found.history["t_s"])
        apart = np.abs(found.history["soc"] - data.soc[rows]) / found.history["soc_sd"]
        inside.append(np.mean(apart[200:] < 2.0))
    assert np.mean(inside) > 0.9
