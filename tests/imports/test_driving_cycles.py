"""Driving cycles as tables: units, gaps, and what can't be."""

from __future__ import annotations

import numpy as np
import pytest

from app.imports.cycle import read_cycle
from app.science.errors import SignalsError
from app.science.vehicle.fuels import FUELS

PETROL = FUELS["petrol"]


def test_units_are_taken_from_the_columns() -> None:
    kmh = read_cycle(b"time_s;speed_kmh;fuel_rate_lph\n0;36,0;3,6\n1;72,0;3,6\n", "a", PETROL)
    assert kmh.speed_mps.tolist() == [10.0, 20.0]
    assert kmh.fuel_power_w is not None
    assert kmh.fuel_power_w == pytest.approx([32e6 / 1000.0] * 2)
    both = read_cycle(b"t_s,speed_mph,fuel_cc_s,fuel_g_s\n0,10,9,1\n1,10,9,1\n", "b", PETROL)
    assert both.speed_mps == pytest.approx([4.4704, 4.4704])
    assert both.fuel_power_w == pytest.approx([32e6 / 745.0] * 2)


def test_rows_become_seconds() -> None:
    cycle = read_cycle(b"t_s,speed_mps\n10,0\n12,4\n12.5,6\n13,8\n", "a", PETROL)
    assert np.array_equal(cycle.speed_mps, [0.0, 2.0, 4.0, 8.0])
    assert cycle.fuel_power_w is None
    assert cycle.distance_m == 14.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t_s,rpm\n0,1\n1,1\n", "No column for the speed: one of speed_mps"),
        ("speed_mps,x\n0,1\n", "No column for the time"),
        ("t_s,speed_mps\n0,1\n1,fast\n", "Row 3, speed_mps: 'fast' is not a number"),
        ("t_s,speed_mps\n0,1\n1,1\n1,1\n", "Row 4: 0 s after the row before"),
        ("t_s,speed_mps\n0,1\n60,1\n", "Row 3: 60 s after the row before"),
        ("t_s,speed_mps\n0,1\n1,180\n", "from 1 to 180 m/s is no car's speed"),
        ("t_s,speed_mps,fuel_g_s\n0,1,1\n1,1,-1\n", "Row 3: the fuel flow is below zero"),
        ("t_s,speed_mps\n0,1\n", "no two rows"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(text: str, words: str) -> None:
    with pytest.raises(SignalsError, match=words):
        read_cycle(text.encode(), "x", PETROL)
