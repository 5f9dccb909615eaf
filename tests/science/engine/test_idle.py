"""Idle out of a drive whose stops are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.engine.document import read_map_document
from app.science.engine.idle import IdleSums, idle_of, idling
from app.science.logger.recording import Recording, Series
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle
from tests.synthetic import drive

CAR = Vehicle(idle_rpm=800.0)
RADPS_PER_RPM = np.pi / 30.0
EVERY_S = np.arange(0.0, 600.0, 0.14)
PULSES = Recording({"injector_pulse_s": Series(EVERY_S, np.full(len(EVERY_S), 0.002))})


def standing(stops: list[tuple[float, float]], rpm: float, fuel_w: float, noise: float = 0.0) -> Observation:
    """A drive of ten minutes that stands between the given times; the engine revs up for a second to start."""
    seen = drive(600.0)
    t, rng = seen.columns["t_s"], np.random.default_rng(1)
    columns = dict(seen.columns) | {
        "speed_mps": np.full(len(t), 15.0),
        "engine_speed_radps": np.full(len(t), 2500.0 * RADPS_PER_RPM),
        "fuel_power_w": np.full(len(t), 30e3),
    }
    for begin, end in stops:
        inside = (t >= begin) & (t < end)
        columns["speed_mps"][inside] = 0.0
        revs = np.where(t > end - 1.0, 1500.0, rpm) * (1.0 + noise * rng.standard_normal(len(t)))
        columns["engine_speed_radps"][inside] = revs[inside] * RADPS_PER_RPM
        columns["fuel_power_w"][inside] = np.where(t > end - 1.0, 15e3, fuel_w)[inside]
    return replace(seen, columns=columns)


def test_idle_of_known_stops() -> None:
    idle = idle_of([idling(standing([(100.0, 130.0), (300.0, 318.0)], 820.0, 3600.0, noise=0.01), PULSES, CAR)], CAR)
    assert idle is not None
    assert idle.rpm == pytest.approx(820.0, abs=2.0)
    assert idle.rpm_sd == pytest.approx(8.2, rel=0.2)
    assert idle.fuel_power_w == pytest.approx(3600.0)
    assert idle.fuel_power_sd_w == pytest.approx(0.0, abs=0.1)
    assert idle.litres_per_hour == pytest.approx(3600.0 * 3600.0 / 32e6)
    assert idle.seconds == pytest.approx(27.0 + 15.0, abs=0.5)


def test_trips_add_up_by_time() -> None:
    long, short = (
        idling(standing([(100.0, 100.0 + s)], rpm, 3600.0), PULSES, CAR) for s, rpm in ((33.0, 800.0), (13.0, 860.0))
    )
    idle = idle_of([long, short, IdleSums.from_dict(None)], CAR)
    assert idle is not None
    assert idle.rpm == pytest.approx((30.0 * 800.0 + 10.0 * 860.0) / 40.0, abs=0.5)
    assert IdleSums.from_dict(long.to_dict()) == long


def test_no_idle_without_fuel_or_stops() -> None:
    rolling = standing([], 800.0, 3600.0)
    assert idle_of([idling(rolling, PULSES, CAR)], CAR) is None
    unknown = standing([(100.0, 130.0)], 800.0, np.nan)
    assert idle_of([idling(unknown, PULSES, CAR)], CAR) is None
    off = standing([(100.0, 130.0)], 0.0, 0.0)
    assert idle_of([idling(off, PULSES, CAR)], CAR) is None


def test_a_slow_bus_leaves_more_of_a_stop_out() -> None:
    asked = np.arange(0.0, 600.0, 7.0)
    slow = Recording({name: Series(asked, asked) for name in ("engine_speed_rpm", "fuel_rate_lph")})
    seen = standing([(100.0, 130.0), (300.0, 312.0)], 820.0, 3600.0)
    assert idling(seen, slow, CAR).seconds == pytest.approx(30.0 - 14.0, abs=0.5)


def test_a_map_made_elsewhere_may_tell_idle_in_two_numbers_and_more_than_ponthy_knows() -> None:
    document = {
        "cell": {"rpm": 50, "nm": 2},
        "cells": [{"rpm": 1025, "nm": 11, "efficiency": 0.2}],
        "idle": {"rpm": 850, "fuel_power_w": 3500, "coolant_c": 90},
    }
    idle = read_map_document(document).idle
    assert idle is not None
    assert (idle.rpm, idle.fuel_power_w, idle.rpm_sd) == (850.0, 3500.0, 0.0)
