"""The road a driver had: its limits leave the driven drive, hold him where he was slow, and free him between."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.ride import Ride
from app.science.eco.road import Freedom, KnownLimits, road_of


def ride(speed_mps: FloatArray, slope: float = 0.02) -> Ride:
    n = len(speed_mps)
    t = 0.1 * np.arange(n)
    return Ride(
        t_s=t,
        dt_s=np.full(n, 0.1),
        distance_m=np.cumsum(speed_mps * 0.1),
        speed_mps=speed_mps,
        accel_mps2=np.gradient(speed_mps, t),
        sin_slope=np.full(n, slope),
        gear=np.full(n, 4),
        engine_radps=np.full(n, 200.0),
        cut=np.zeros(n, np.bool_),
    )


def bend() -> FloatArray:
    """20 m/s, once down to 10, and a ripple in between."""
    t = np.arange(0.0, 120.0, 0.1)
    return 20.0 - 10.0 * np.exp(-(((t - 60.0) / 5.0) ** 2)) + 0.4 * np.sin(t)


def limits_at(speed: FloatArray, limits: KnownLimits | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
    driven = ride(speed)
    road = road_of(driven, Freedom(), limits)
    places = np.concatenate(([0.0], np.cumsum(driven.speed_mps * 0.1)))[:-1]
    cell = np.clip(np.searchsorted(road.distance_m, places + 1e-9, side="right") - 1, 0, None)
    return places, np.array(road.speed_limit_mps)[cell], np.array(road.elevation_m)


def test_the_driven_drive_keeps_the_limits() -> None:
    speed = bend()
    _, limit, elevation = limits_at(speed)
    assert (limit >= speed - 1e-9).all()
    assert elevation[-1] == 0.02 * np.sum(speed * 0.1) or abs(elevation[-1] - 0.02 * np.sum(speed * 0.1)) < 1e-6


def test_a_bend_holds_and_a_ripple_does_not() -> None:
    speed = bend()
    _, limit, _ = limits_at(speed)
    slowest = int(speed.argmin())
    assert limit[slowest] < speed[slowest] + 2.0
    assert limit[300] > 20.3
    assert limit[900] > 20.3


def test_a_known_limit_takes_the_place_of_what_was_driven_nearby_but_not_of_a_bend() -> None:
    speed = bend()
    known = KnownLimits(np.array([0.0, 1000.0]), np.array([25.0, np.nan]))
    places, limit, _ = limits_at(speed, known)
    assert (limit[(places > 100.0) & (places < 500.0)] >= 25.0).mean() > 0.8
    assert limit[int(speed.argmin())] < 13.0
    assert limit[-50] < 21.0
