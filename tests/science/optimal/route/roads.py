"""Routes that tests share: hills, a stretch of lower limit, and cars whose fuel is convex."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.science.optimal.problem import Route
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SIX_GEARS, SMART

WILLANS = {"willans": [5000.0, 2.2, 1e-5], "power_w": [0.0, 40000.0], "force_n": [-3000.0, 4000.0]}
CONVEX = {
    "p_in": [2000.0, 9.0, 0.02, 2.2, 0.0008], "terms": ["1", "w", "w2", "wT", "wT2"], "speed_rpm": [1000, 6000],
    "torque_nm": [0, 100], "full_load": None, "idle_fuel_power_w": 3000.0,
}  # fmt: skip
GEARS = SIX_GEARS | {"neutral": True}


def hills(length_m: float = 4000.0, points: int = 81, slow_mps: float = 15.0) -> dict[str, Any]:
    """Return a road that rises and falls, with a lower limit in its second third."""
    s = np.linspace(0.0, length_m, points)
    limit = np.full(points, 25.0)
    limit[points // 3 : points // 2] = slow_mps
    high = 20.0 * np.sin(2.0 * np.pi * s / 1500.0) + 5.0 * np.sin(2.0 * np.pi * s / 400.0)
    return {"distance_m": s.tolist(), "elevation_m": high.tolist(), "speed_limit_mps": limit.tolist()}


def posed(**changes: Any) -> Route:
    """Return a Willans drive over the hills, with changes to the document."""
    document = {
        "kind": "route", "vehicle": dict(SMART), "engine": dict(WILLANS), "road": hills(), "from_speed_mps": 10.0,
        "to_speed_mps": 12.0, "min_speed_mps": 3.0, "max_time_s": 260.0, "brake_max_n": 5000.0,
    }  # fmt: skip
    problem = read_problem(document | changes)
    assert isinstance(problem, Route)
    return problem
