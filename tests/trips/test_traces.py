"""Traces: few samples, every spike, any window."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import Invalid, PonthyError
from app.trips.models import Trip
from app.trips.traces import at, traces, unit_of
from tests.synthetic import drive, random_points
from tests.yards import Yard

SPIKE_AT = 4321
OBSERVATION = drive(seconds=6000.0)
SPEED = OBSERVATION.columns["speed_mps"].copy()
SPEED[SPIKE_AT] = 99.0
OBSERVATION = replace(OBSERVATION, columns={**OBSERVATION.columns, "speed_mps": SPEED})
TIME = OBSERVATION.columns["t_s"]


@pytest.fixture
def trip(yard: Yard) -> Trip:
    return yard.trip(yard.observed("long", OBSERVATION, random_points(10)))


def test_a_spike_of_one_sample_is_seen_at_full_zoom_out(yard: Yard, trip: Trip) -> None:
    answer = traces(yard.resources.blobs, trip, ["speed_mps", "thrust_n"], None, None, 500)
    speed = answer["signals"]["speed_mps"]
    assert answer["total"] == len(TIME) == 60_000
    assert answer["shown"] <= 500
    assert max(speed["value"]) == 99.0
    assert speed["t_s"][int(np.argmax(speed["value"]))] == pytest.approx(TIME[SPIKE_AT])
    assert len(speed["sd"]) == len(speed["value"]) == len(speed["t_s"])
    assert (answer["from_s"], answer["to_s"]) == (TIME[0], TIME[-1])


@pytest.mark.parametrize(
    ("from_s", "to_s"), [(0.0, 3.0), (431.93, 432.25), (5990.0, 1e6), (-50.0, 0.05), (100.0, None)]
)
def test_a_window_holds_every_sample_and_one_on_each_side(
    yard: Yard, trip: Trip, from_s: float, to_s: float | None
) -> None:
    answer = traces(yard.resources.blobs, trip, ["speed_mps"], from_s, to_s, 100_000)
    first = max(int(np.searchsorted(TIME, from_s)) - 1, 0)
    last = len(TIME) if to_s is None else min(int(np.searchsorted(TIME, to_s, "right")) + 1, len(TIME))
    assert answer["signals"]["speed_mps"]["value"] == SPEED[first:last].tolist()
    assert answer["total"] == last - first


def test_what_is_not_known_is_null(yard: Yard, trip: Trip) -> None:
    efficiency = traces(yard.resources.blobs, trip, ["efficiency"], None, None, 100_000)["signals"]["efficiency"]
    known = np.isfinite(OBSERVATION.columns["efficiency"])
    assert not known.all()
    assert [value is not None for value in efficiency["value"]] == known.tolist()
    assert efficiency["sd"] is None


def test_one_moment_has_all_columns(yard: Yard, trip: Trip) -> None:
    row = at(yard.resources.blobs, trip, float(TIME[SPIKE_AT]) + 0.03)
    assert row["speed_mps"] == 99.0
    assert set(row) == set(OBSERVATION.columns)
    assert at(yard.resources.blobs, trip, 1e9)["t_s"] == TIME[-1]
    assert at(yard.resources.blobs, trip, -5.0)["t_s"] == TIME[0]


def test_unknown_signals_and_empty_windows_are_named(yard: Yard, trip: Trip) -> None:
    with pytest.raises(Invalid, match="no signal 'warp_factor'"):
        traces(yard.resources.blobs, trip, ["warp_factor"], None, None, 100)
    with pytest.raises(Invalid, match="empty"):
        traces(yard.resources.blobs, trip, ["speed_mps"], 5.0, 4.0, 100)
    with pytest.raises(PonthyError, match="no result yet"):
        traces(yard.resources.blobs, yard.trip(), ["speed_mps"], None, None, 100)


def test_names_carry_their_units() -> None:
    units = {"speed_mps": "m/s", "bias_i_mps2": "m/s²", "curvature_h_radpm": "rad/m", "engine_speed_radps": "rad/s"}
    units |= {"torque_nm": "Nm", "efficiency": "", "gear": "", "lat_deg": "°", "fuel_power_w": "W", "distance_m": "m"}
    assert {name: unit_of(name) for name in units} == units
    assert unit_of("speed_mps_sd") == "m/s"
