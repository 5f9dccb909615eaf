"""Which way the current is counted, told from the voltage alone; right data are never turned."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.imports.battery import read_battery
from app.science.battery.config_reading import read_config
from app.science.battery.record import BatteryRecord
from app.science.battery.response import response_of
from app.science.battery.sign import counted_rightly
from tests.science.battery.plain_cell import CONFIG, INITIAL_OF_LAB, TRUTH, driven


def turned(record: BatteryRecord, capacity_ah: float = 2.0) -> bool:
    config = read_config(CONFIG | {"initial": INITIAL_OF_LAB | {"capacity_ah": capacity_ah}})
    return counted_rightly(record, config, response_of(record)).turned


def both_ways(record: BatteryRecord, capacity_ah: float = 2.0) -> tuple[bool, bool]:
    """Return whether the record is turned as it is, and whether it is when its sign is swapped."""
    return turned(record, capacity_ah), turned(replace(record, current_a=-record.current_a), capacity_ah)


def test_the_response_is_the_resistance() -> None:
    response = response_of(driven(6000))
    # the relaxation takes a part of a step's row already
    assert response.ohm == pytest.approx(TRUTH["resistance_ohm"], rel=0.05)
    assert response.noise_v == pytest.approx(0.002, rel=0.15)
    assert (response.lag, response.agreement) == (0, 1.0)


@pytest.mark.parametrize("rows", [300, 600, 6000])
def test_driving_is_turned_only_when_it_is_swapped(rows: int) -> None:
    assert both_ways(driven(rows)) == (False, True)


@pytest.mark.parametrize("lag", [-3, -1, 1, 3])
def test_a_voltage_some_rows_off_does_not_confuse(lag: int) -> None:
    record = driven(6000)
    shifted = replace(record, voltage_v=np.roll(record.voltage_v, lag))
    assert response_of(shifted).lag == lag
    assert both_ways(shifted) == (False, True)


@pytest.mark.parametrize("hold", [1, 3, 20, 600])
@pytest.mark.parametrize("noise_v", [0.0, 0.002, 0.02])
@pytest.mark.parametrize("ohm", [1e-4, 1e-3, 1e-2])
def test_right_data_are_never_turned(ohm: float, noise_v: float, hold: int) -> None:
    rng = np.random.default_rng(int(1e6 * ohm) + hold)
    for rows in (60, 2000):
        amps = np.repeat(rng.normal(-1.0, 2.0, rows // hold + 2), hold)[:rows]
        for lag in (-5, -2, 0, 1, 5):
            volts = np.roll(3.4 + 0.3 * np.cumsum(amps) / 7200.0 + ohm * amps, lag) + noise_v * rng.normal(size=rows)
            record = BatteryRecord(np.arange(float(rows)), amps + 0.01 * rng.normal(size=rows), np.round(volts, 4))
            assert not turned(record), (rows, lag)


def test_a_constant_discharge_tells_by_its_trend() -> None:
    t_s = np.arange(0.0, 3000.0, 10.0)
    record = BatteryRecord(t_s, np.full(len(t_s), -1.0), 3.6 - 1e-4 * t_s)
    assert both_ways(record) == (False, True)


def test_discharges_of_a_real_cell_through_its_life(shared_data: Callable[[str], Path]) -> None:
    with gzip.open(shared_data("nasa-b0018-aging") / "B0018_discharge.csv.gz", "rt") as file:
        rows = list(csv.DictReader(file))
    cycles: dict[str, list[tuple[float, float, float]]] = {}
    for row in rows:
        cycles.setdefault(row["cycle_number"], []).append(
            (float(row["time_s"]), float(row["current"]), float(row["voltage"]))
        )
    told = [both_ways(BatteryRecord(*np.array(cycle).T)) for cycle in cycles.values()]
    assert len(told) == 132
    assert set(told) == {(False, True)}


def test_pulses_and_discharges_of_a_real_cell(shared_data: Callable[[str], Path]) -> None:
    for path in sorted(shared_data("leaf-cell-ecm").glob("cell-*.csv.gz")):
        assert both_ways(read_battery(path), 33.1) == (False, True), path.name
