"""A long drive is told by stretches of its limit, each with its speeds, gears, torque, rolling and braking."""

from __future__ import annotations

import numpy as np

from app.science.optimal.answer import Trajectory
from app.science.optimal.route.telling import by_stretches, told
from tests.science.optimal.route.roads import posed

ROAD = {"distance_m": [0, 6060, 8060], "elevation_m": [0, 0, 0], "speed_limit_mps": [25, 12, 12]}


def pulsing() -> Trajectory:
    """Return ten pulses of 30 s in third gear at 80 Nm and 30 s in neutral, then 166.67 s along at 12 m/s."""
    pulses = [row for k in range(10) for row in ((60.0 * k, 8.0, 3), (60.0 * k + 30.0, 12.0, 0))]
    rows = np.array([*pulses, (600.0, 12.0, 4), (600.0 + 2000.0 / 12.0, 12.0, 4)])
    times = np.sort(np.concatenate((rows[:, 0], rows[1:-1, 0])))
    speed = np.interp(times, rows[:, 0], rows[:, 1])
    gear = np.repeat(rows[:, 2], 2)[:-2].astype(np.int64)
    distance = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))))
    pulls = gear > 0
    torque = np.where(gear == 3, 80.0, np.where(gear == 4, 20.0, np.nan))
    none = np.zeros(len(times))
    return Trajectory(times, distance, speed, gear, np.where(pulls, 250.0, np.nan), torque, none, none)


def test_stretches_say_what_is_done() -> None:
    drive = pulsing()
    assert drive.distance_m[-1] == 8060.0
    problem = posed(road=ROAD, from_speed_mps=8.0)
    assert any("swing between" in line for line in told(problem, drive))
    first, second = by_stretches(problem, drive)
    assert (
        first
        == "0.0 to 6.1 km: 29 to 43 km/h, 43 at its end; pull in gear 3 with about 80 Nm; roll in neutral for 300 s"
    )
    assert second == "6.1 to 8.1 km: hold 43 km/h; pull in gear 4 with about 20 Nm"
