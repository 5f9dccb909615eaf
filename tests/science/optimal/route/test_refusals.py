"""Routes nobody can drive are refused by the number that is impossible, and by how much."""

from __future__ import annotations

from typing import Any

import pytest

from app.science.optimal.problem import Infeasible
from app.science.optimal.route.solving import solve
from app.science.progress import silent
from tests.science.optimal.route.roads import CONVEX, GEARS, WILLANS, posed

LEVEL = {"distance_m": [0, 500, 1000], "elevation_m": [0, 0, 0], "speed_limit_mps": [20, 20, 20]}
SLOW = LEVEL | {"speed_limit_mps": [20, 6, 6]}
HILL = LEVEL | {"elevation_m": [0, 0, 200]}
GAP = {"distance_m": [0, 1000, 9000], "elevation_m": [0, 10, 200], "speed_limit_mps": [25, 25, 25]}
WEAK = WILLANS | {"power_w": [0.0, 15000.0]}


@pytest.mark.parametrize(
    ("changes", "limit", "words"),
    [
        ({"from_speed_mps": 22.0}, "from_speed_mps", "22 m/s is 2 m/s above the limit of 20 m/s"),
        ({"to_speed_mps": 26.0}, "to_speed_mps", "26 m/s is 6 m/s above the limit of 20 m/s"),
        ({"from_speed_mps": 2.0}, "from_speed_mps", "2 m/s is 1 m/s below min_speed_mps, 3 m/s"),
        ({"road": LEVEL | {"speed_limit_mps": [20, 2, 20]}}, "road.speed_limit_mps[1]", "500 m on, 2 m/s, is 1 m/s"),
        ({"road": GAP}, "road.distance_m[2]", "a gap of 8000 m after 1000 m"),
        ({"road": SLOW, "to_speed_mps": 6.0, "brake_max_n": 0.0, "from_speed_mps": 20.0}, "brake_max_n", "no brakes"),
        ({"road": HILL, "engine": WEAK, "min_speed_mps": 9.5}, "engine.power_w", "too steep before"),
        ({"max_time_s": 40.0}, "max_time_s", "40 s are too short by"),
        ({"road": LEVEL | {"distance_m": [0, 5, 10]}, "to_speed_mps": 19.0}, "to_speed_mps", "m/s short"),
        (
            {"engine": CONVEX, "transmission": GEARS, "from_speed_mps": 0.0, "min_speed_mps": 0.0}, "from_speed_mps",
            "below the lowest speed of first gear, 2.335 m/s",
        ),
        (
            {"engine": CONVEX, "transmission": {"type": "gears", "ratios": [13.25]}, "to_speed_mps": 15.0},
            "to_speed_mps", "can't be reached by the road's end: the car gets to 14.01 m/s",
        ),
        (
            {
                "engine": CONVEX | {"torque_nm": [10, 100]}, "transmission": {"type": "cvt"}, "from_speed_mps": 0.0,
                "min_speed_mps": 0.0,
            }, "from_speed_mps", "gives 1047 W at least",
        ),
    ],
)  # fmt: skip
def test_refused_by_the_number(changes: dict[str, Any], limit: str, words: str) -> None:
    with pytest.raises(Infeasible) as refused:
        solve(posed(**({"road": LEVEL} | changes)), silent)
    assert words in str(refused.value)
    assert limit in refused.value.limit


def test_least_time_is_told_exactly() -> None:
    """With 4000 N from 10 to 20 m/s, along at 20 m/s, and down to 12 m/s with 5000 N of brakes."""
    with pytest.raises(Infeasible, match=r"it takes (\S+) s") as refused:
        solve(posed(road=LEVEL, engine=WILLANS | {"power_w": [0.0, 1e6]}, max_time_s=40.0), silent)
    told = float(str(refused.value).rsplit("takes ", 1)[1].split(" s")[0])
    drag, rolling, mass = 0.5 * 1.2 * 0.39 * 1.93, 0.01 * 920.0 * 9.805, 948.0
    up = mass * 10.0 / (4000.0 - rolling - drag * 15.0**2)
    down = mass * 8.0 / (5000.0 + rolling + drag * 16.0**2)
    along = 1000.0 - 15.0 * up - 16.0 * down
    assert told == pytest.approx(up + down + along / 20.0, rel=2e-4)


def test_the_last_points_limit_holds_for_nothing() -> None:
    road = {"distance_m": [0.0, 200.0, 400.0], "elevation_m": [0.0] * 3}
    taken = [
        solve(posed(road=road | {"speed_limit_mps": [20.0, 20.0, last]}, max_time_s=None), silent).found.way.taken_j
        for last in (20.0, 1.0)
    ]
    assert taken[0] == taken[1]
