"""Capacity followed over an ageing cell's life, mostly from the first half of its discharges."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from app.science.battery.circuit import Cell, Circuit
from app.science.battery.curve import voltage_at
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate
from app.science.battery.tracking import Tracked, Tracking, track, usable_ah
from app.science.errors import TooLittleData
from tests.science.battery.made_cells import CIRCUIT, NMC
from tests.science.battery.real_cells import nasa_discharges

MADE = Tracking(CIRCUIT, (3.05, 4.19), first=1)
PARTIAL_V = 3.5
EVERY = 10
LONG_PAUSE_S = 48 * 3600.0


def discharge(capacity_ah: float, resistance_ohm: float, share: float, seed: int) -> BatteryRecord:
    circuit = replace(CIRCUIT, capacity_ah=capacity_ah, resistance_ohm=resistance_ohm)
    t_s = np.arange(0.0, 3600.0 * share + 60.0, 10.0)
    current = np.where(t_s < 60.0, 0.0, -capacity_ah)
    told = simulate(Cell(NMC, circuit, 1.0), t_s, current).voltage_v
    return BatteryRecord(t_s, current, told + 5e-4 * np.random.default_rng(seed).standard_normal(len(t_s)))


def test_a_made_cell_that_fades() -> None:
    ages = np.linspace(0.0, 1.0, 21)
    true_ah, ohms = 5.0 - ages, 0.02 + 0.01 * ages
    shares = [1.05, *[0.55] * 20]
    records = [discharge(*one) for one in zip(true_ah, ohms, shares, range(21), strict=True)]
    found = list(track(records, MADE))
    assert [one.measured for one in found] == [True, *[False] * 20]
    whole = [usable_ah(NMC, Circuit(q, r, 2000.0, 0.015), q, 3.05) for q, r in zip(true_ah, ohms, strict=True)]
    np.testing.assert_allclose([one.capacity_ah for one in found], whole, rtol=0.02)
    assert found[-1].circuit.resistance_ohm == pytest.approx(0.03, rel=0.1)


def test_usable_capacity_is_what_a_simulated_discharge_gives() -> None:
    t_s = np.arange(0.0, 4000.0)
    volts = simulate(Cell(NMC, CIRCUIT, 1.0), t_s, np.full(4000, -5.0)).voltage_v
    lasted_s = float(np.interp(-3.05, -volts, t_s))
    assert usable_ah(NMC, CIRCUIT, 5.0, 3.05) == pytest.approx(5.0 * lasted_s / 3600.0, rel=1e-3)
    assert voltage_at(NMC.pieces, np.zeros(1))[0] < 3.05


def test_the_first_discharge_must_be_full() -> None:
    with pytest.raises(TooLittleData, match="full discharges"):
        list(track([discharge(5.0, 0.02, 0.5, 0)], MADE))


@pytest.fixture(scope="module")
def aged(shared_data: Callable[[str], Path]) -> tuple[list[Tracked], list[float]]:
    """Return what is said of all 132 discharges of NASA's B0018, and their capacities.

    The first three, each tenth and those after more than two days' rest are seen whole, all others down to 3.5 V.
    """
    folder = shared_data("nasa-b0018-aging")
    with (folder / "B0018_capacity.csv").open(encoding="utf-8") as file:
        starts = [datetime.fromisoformat(row["start_time"]).timestamp() for row in csv.DictReader(file)]
    discharges = list(nasa_discharges(folder).values())
    pauses = [0.0, *(b - a - one[0].t_s[-1] for (a, b), one in zip(pairwise(starts), discharges[:-1], strict=True))]
    records: list[BatteryRecord] = []
    since = 0
    for k, ((record, _), pause_s) in enumerate(zip(discharges, pauses, strict=True)):
        since += 1
        whole = k < 3 or since >= EVERY or pause_s > LONG_PAUSE_S
        since = 0 if whole else since
        records.append(record if whole else above(record, PARTIAL_V))
    ohms = 0.1  # of the first discharge: 0.21 V in its first ten seconds of 2.0 A
    tracking = Tracking(Circuit(2.0, ohms, 400.0 / 0.06, 0.06), (2.7, 4.15))
    return list(track(records, tracking)), [told for _, told in discharges]


def above(record: BatteryRecord, volts: float) -> BatteryRecord:
    rows = slice(None, int(np.flatnonzero((record.voltage_v < volts) & (record.current_a < -1.0))[0]))
    return BatteryRecord(record.t_s[rows], record.current_a[rows], record.voltage_v[rows])


def test_nasa_fade_is_followed_from_half_discharges(aged: tuple[list[Tracked], list[float]]) -> None:
    found, told = aged
    partial = np.array([not one.measured for one in found])
    assert partial.sum() == 116
    off = np.array([one.capacity_ah for one in found]) / np.array(told) - 1.0
    assert np.abs(off[~partial]).max() < 4e-3
    assert np.median(np.abs(off[partial])) < 0.01
    assert (np.abs(off[partial]) < 0.03).mean() > 0.97
    within = np.abs(off * told)[partial] < 2.0 * np.array([one.sd_ah for one in found])[partial]
    assert within.mean() > 0.8


def test_holding_the_last_full_discharge_is_worse(aged: tuple[list[Tracked], list[float]]) -> None:
    found, told = aged
    held, last = [], 0.0
    for one in found:
        last = one.capacity_ah if one.measured else last
        held.append(last)
    partial = np.array([not one.measured for one in found])
    off = np.abs(np.array(held) / np.array(told) - 1.0)[partial]
    assert (off < 0.03).mean() < 0.8
