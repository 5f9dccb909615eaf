"""What a pause does to what is known of a cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.battery.carrying import OPEN_SOC_SD, between, open_soc
from app.science.battery.circuit import Cell, Circuit, Warmth
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit
from app.science.battery.run import Carry

DAY_S = 86400.0
CONFIG = BatteryConfig(
    Cell(OpenCircuit(coefficients=(3.0, 0.5)), Circuit(2.0, 0.008, 2700.0, 0.011), 0.5), current_bias_a=0.02
)


def known() -> Carry:
    sd = np.array([0.02, 0.01, 0.05, 0.05, 0.01, 0.003, 0.005])
    together = np.full((7, 7), 0.5) + 0.5 * np.eye(7)
    mean = np.array([np.log(7200.0), np.log(0.008), np.log(2700.0), np.log(0.011), 0.6, 0.02, 0.01])
    return Carry(mean, together * np.outer(sd, sd), 1000.0)


def sds(carry: Carry) -> np.ndarray:
    return np.sqrt(np.diag(carry.covariance))


def test_no_pause_changes_nothing_and_a_clock_that_ran_back_is_no_pause() -> None:
    for gap_s in (0.0, -50.0):
        after = between(known(), gap_s, CONFIG)
        assert after.mean == pytest.approx(known().mean)
        assert after.covariance == pytest.approx(known().covariance)


def test_a_minute_keeps_the_charge_and_lets_the_relaxation_fade() -> None:
    after = between(known(), 60.0, CONFIG)
    assert sds(after)[4] == sds(known())[4]
    assert after.mean[5] == pytest.approx(0.02 * np.exp(-60.0 / (2700.0 * 0.011)))
    assert sds(after)[0] == pytest.approx(0.02, rel=1e-3)
    assert after.t_s == 1060.0


def test_after_hours_the_charge_is_open_and_tells_nothing_of_the_capacity() -> None:
    after = between(known(), 8 * 3600.0, CONFIG)
    assert sds(after)[4] >= OPEN_SOC_SD * 0.99
    assert np.all(after.covariance[4, [0, 1, 2, 3, 5, 6]] == 0.0)
    assert after.mean[5] == pytest.approx(0.0, abs=1e-12)
    assert sds(after)[5] == pytest.approx(OPEN_SOC_SD * 2.0 * 0.011, rel=0.01)  # a charger's current a moment ago
    half_an_hour = sds(between(known(), 1800.0, CONFIG))[4]
    assert 0.01 < half_an_hour <= sds(after)[4]


def test_the_capacity_walks_up_to_a_bound_and_the_bias_returns_to_its_prior() -> None:
    month = between(known(), 30 * DAY_S, CONFIG)
    assert sds(month)[0] == pytest.approx(np.hypot(0.02, 0.002 * np.sqrt(30.0)))
    assert (month.mean[6], sds(month)[6]) == pytest.approx(
        (0.01 * np.exp(-1.0), np.sqrt((0.005 * np.exp(-1.0)) ** 2 + (1.0 - np.exp(-2.0)) * 0.02**2))
    )
    assert sds(between(known(), 1e9, CONFIG))[0] == pytest.approx(0.2)


def test_a_night_may_have_changed_the_temperature_and_the_resistances_with_it() -> None:
    night = between(known(), 12 * 3600.0, CONFIG)
    share = 1.0 - np.exp(-4.0)
    assert sds(night)[1:4] == pytest.approx(np.sqrt(np.array([0.01, 0.05, 0.05]) ** 2 + share * 0.3**2))
    compensated = replace(CONFIG, cell=replace(CONFIG.cell, warmth=Warmth(resistance_k=2500.0)))
    assert sds(between(known(), 12 * 3600.0, compensated))[1] == pytest.approx(np.sqrt(0.01**2 + share * 0.1**2))
    assert sds(between(known(), 60.0, CONFIG))[1] < 0.03


@pytest.mark.parametrize("gap_s", [1.0, 400.0, 3600.0, 1e5, 1e9])
def test_what_is_left_is_a_covariance(gap_s: float) -> None:
    after = between(known(), gap_s, CONFIG)
    assert after.covariance == pytest.approx(after.covariance.T)
    assert np.linalg.eigvalsh(after.covariance).min() > -1e-15
    assert np.linalg.eigvalsh(open_soc(after, 0.1).covariance).min() > -1e-15
