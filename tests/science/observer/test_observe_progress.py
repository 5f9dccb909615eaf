"""What an observer run costs in memory, that it says how far it is, and that it stops when told to."""

from __future__ import annotations

import gc
import tracemalloc

import numpy as np
import pytest

from app.science.logger.decode import ImageDecoder
from app.science.logger.recording import Recording
from app.science.logger.stretch import Timed
from app.science.observer.observe import observe
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

TRIP = simulate(Simulation(duration_s=600.0, seed=77))
VEHICLE = read_vehicle(TRIP.car_xml)


@pytest.fixture
def recording() -> Recording:
    return next(ImageDecoder().trips([TRIP.image]))


@pytest.fixture
def small_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.science.observer.motion.STRETCHES_AT_ONCE", 5)


class Stopped(Exception):  # noqa: N818 - reads as the condition it names
    """Somebody asked to stop."""


@pytest.mark.parametrize("smooth", [True, False])
def test_progress_only_grows_and_is_told_often(recording: Recording, small_steps: None, smooth: bool) -> None:
    told: list[float] = []
    observe(recording, VEHICLE, smooth=smooth, progress=told.append)
    assert told == sorted(told)
    assert 0.0 <= told[0] < 0.1
    assert 0.9 < told[-1] <= 1.0
    assert max(np.diff(told)) < 0.2


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9])
def test_what_progress_raises_ends_the_run_at_once(recording: Recording, small_steps: None, share: float) -> None:
    told: list[float] = []

    def stop_at(done: float) -> None:
        told.append(done)
        if done >= share:
            raise Stopped

    with pytest.raises(Stopped):
        observe(recording, VEHICLE, progress=stop_at)
    assert all(done < share for done in told[:-1])


def test_the_result_does_not_depend_on_the_steps(recording: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = observe(recording, VEHICLE)
    monkeypatch.setattr("app.science.observer.motion.STRETCHES_AT_ONCE", 3)
    pieces = observe(recording, VEHICLE)
    for name, column in whole.columns.items():
        np.testing.assert_array_equal(pieces.columns[name], column)
    np.testing.assert_array_equal(pieces.innovations.innovation, whole.innovations.innovation)


def test_memory_stays_near_that_of_the_result(recording: Recording) -> None:
    observe(recording, VEHICLE)  # compiles
    tracemalloc.start()
    seen = observe(recording, VEHICLE)
    held, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert held < 1.2 * (sum(c.nbytes for c in seen.columns.values()) + 26 * len(seen.innovations.t_s))
    assert peak < 2.2 * held


def test_a_trip_handed_out_leaves_none_of_its_packets_behind() -> None:
    trips = ImageDecoder().trips([TRIP.image])
    recording = next(trips)
    packets = sum(len(held) for held in gc.get_objects() if isinstance(held, Timed))
    assert packets < 0.02 * len(recording["ax_mps2"])
    assert next(trips, None) is None
