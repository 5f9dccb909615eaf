"""Capacities between ends, against made cells and the cyclers' own counters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from app.science.battery.capacity_test import capacity_tests
from tests.science.battery.made_cells import NMC, cycled
from tests.science.battery.real_cells import leaf_counter_ah, leaf_record, nasa_discharges


def test_full_discharge_and_charge_of_a_made_cell() -> None:
    discharge, charge = capacity_tests(cycled(NMC, 0.1, noise_v=0.0), (3.0, 4.19))
    assert (discharge.direction, charge.direction) == ("discharge", "charge")
    assert abs(discharge.capacity_ah - 5.0) < 3.0 * discharge.sd_ah + 0.03
    assert discharge.current_a == pytest.approx(0.5)


def test_a_part_of_a_discharge_is_no_test() -> None:
    whole = cycled(NMC, 0.1)
    part = replace(whole, t_s=whole.t_s[:2500], current_a=whole.current_a[:2500], voltage_v=whole.voltage_v[:2500])
    assert capacity_tests(part, (3.0, 4.19)) == ()
    assert capacity_tests(part) == ()


@pytest.mark.parametrize("name", ["cell-discharge-bitrode-1c", "cell-discharge-bitrode-2c"])
def test_leaf_capacities_are_the_cyclers(name: str, shared_data: Callable[[str], Path]) -> None:
    folder = shared_data("leaf-cell-ecm")
    found = [one for one in capacity_tests(leaf_record(folder, name)) if one.direction == "discharge"]
    assert len(found) == 4
    counted = leaf_counter_ah(folder, name, "DCHG")
    assert max(one.capacity_ah for one in found) == pytest.approx(counted, abs=0.02)
    assert all(0.02 < one.sd_ah < 0.2 for one in found)


def test_leaf_pulses_are_one_discharge(shared_data: Callable[[str], Path]) -> None:
    found = capacity_tests(leaf_record(shared_data("leaf-cell-ecm"), "cell-low-current-hppc-25c-2"))
    assert [one.direction for one in found] == ["discharge"]
    assert found[0].capacity_ah == pytest.approx(30.47, abs=0.05)  # ten counts of 3.18 Ah but one pulse, and 1.85 Ah


def test_nasa_capacities_to_its_end_voltage(shared_data: Callable[[str], Path]) -> None:
    for record, told_ah in list(nasa_discharges(shared_data("nasa-b0018-aging")).values())[::10]:
        (found,) = capacity_tests(record, (2.7, 4.15))
        assert found.capacity_ah == pytest.approx(told_ah, rel=4e-3)
