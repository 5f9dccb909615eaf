"""Problem documents that tests share."""

from __future__ import annotations

from typing import Any

SMART = {
    "mass_kg": 920.0,
    "accelerated_mass_kg": 948.0,
    "cd": 0.39,
    "frontal_area_m2": 1.93,
    "crr": 0.010,
    "air_density_kgpm3": 1.2,
    "gravity_mps2": 9.805,
    "wheel_radius_m": 0.2954,
}
TABLE_4_1 = {
    "phi": [9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04],
    "speed_rpm": [1000, 6000],
    "torque_nm": [10, 100],
    "full_load": None,
    "idle_fuel_power_w": 0,
}
SIX_GEARS = {
    "type": "gears",
    "ratios": [13.25, 9.604, 7.37, 5.796, 4.208, 3.23],
    "neutral": False,
    "shift_cost_j": 0,
}


def thesis(**changes: Any) -> dict[str, Any]:
    """Return the thesis' car that accelerates from 36 to 100 km/h (4.4.2.1), with changes to the document."""
    return {
        "kind": "accelerate",
        "vehicle": dict(SMART),
        "engine": dict(TABLE_4_1),
        "transmission": dict(SIX_GEARS),
        "from_speed_mps": 10.0,
        "to_speed_mps": 100.0 / 3.6,
        "time_s": None,
    } | changes
