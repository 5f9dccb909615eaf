"""The hybrid's current over FTP-72: its energy, its limits, and how long the battery lasts."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.science.battery.virtual.current import BlendedCar, Cells, cell_current, current_of, wheel_power
from app.science.battery.virtual.ftp72 import ftp_72

CAR = BlendedCar()


def test_cycle_is_the_published_one(shared_data: Callable[[str], Path]) -> None:
    with (shared_data("drive-cycles-fastsim") / "udds.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    t_s, speed = ftp_72()
    np.testing.assert_array_equal(t_s, [float(row["cycSecs"]) for row in rows])
    np.testing.assert_allclose(speed, [float(row["cycMps"]) for row in rows], atol=5e-4)


def test_cycle_is_as_long_and_as_fast_as_the_regulation_says() -> None:
    _, speed = ftp_72()
    assert speed.sum() == pytest.approx(7.45 * 1609.344, rel=1e-3)
    assert speed.max() == pytest.approx(56.7 * 0.44704)


def test_power_at_the_wheels_is_what_the_road_takes_and_inertia_gives_back() -> None:
    """Over a cycle from standing to standing, inertia takes nothing."""
    _, speed = ftp_72()
    mean = 0.5 * (speed[1:] + speed[:-1])
    spent = wheel_power(CAR, speed).sum()
    road = (CAR.mass_kg * 9.81 * 0.008 * mean + 0.5 * 1.2 * 0.58 * mean**3).sum()
    assert spent == pytest.approx(road, rel=1e-9)


def test_current_gives_the_power_back_through_the_cell() -> None:
    cells = Cells()
    power = np.array([-40e3, -600.0, 0.0, 600.0, 35e3])
    current = current_of(cells, power)
    volts = cells.cell_v + cells.resistance_ohm * current
    np.testing.assert_allclose(-cells.count * volts * current, power, atol=1e-6)
    assert cells.count == pytest.approx(2424.2, abs=0.1)


def test_battery_is_mostly_discharged_and_lasts_as_long_as_in_figure_28() -> None:
    """Nearly three cycles in ten hours: 60 % of 2 Ah in less than three hours, and 36 minutes of charging at 2 A."""
    current = cell_current(CAR, *ftp_72())
    assert len(current) == 1369
    assert current.mean() == pytest.approx(-0.418, abs=0.002)
    assert np.sqrt((current**2).mean()) == pytest.approx(1.08, abs=0.01)
    assert (current.min(), current.max()) == (pytest.approx(-5.42, abs=0.02), pytest.approx(2.37, abs=0.02))
    assert 10.0 / (0.6 * 2.0 / -current.mean() + 0.6 * 2.0 / 2.0) == pytest.approx(2.9, abs=0.1)


def test_standing_car_takes_its_auxiliaries() -> None:
    current = cell_current(CAR, np.array([0.0, 60.0]), np.zeros(2))
    np.testing.assert_allclose(current, -600.0 / (CAR.cells.count * 3.3), rtol=1e-3)


def test_recovery_stops_at_its_limit() -> None:
    t_s, speed = np.array([0.0, 5.0]), np.array([35.0, 15.0])
    free, held = (cell_current(replace(CAR, recovery_w=limit), t_s, speed) for limit in (1e6, 10e3))
    assert free.max() > 3.0 * held.max()
    volts = 3.3 + 0.019 * held
    np.testing.assert_allclose(CAR.cells.count * volts * held, 10e3 - 600.0, rtol=1e-9)
