"""Random cars and what they are to do."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.science.optimal.documents import TABLE_4_1


def random_problem(seed: int) -> dict[str, Any]:
    """Return an acceleration of a random car in free time."""
    rng = np.random.default_rng(seed)
    mass = float(rng.uniform(800, 2400))
    size = float(mass / 920 * rng.uniform(0.8, 1.3))
    rev = float(rng.uniform(0.75, 1.2))
    # Table 4.1's engine, scaled in torque and in speed
    scale = [1.0, 1.0 / rev, 1.0 / size, 1.0 / (rev * size), 1.0 / rev**2, 1.0 / size**2]
    phi = [c * s for c, s in zip(TABLE_4_1["phi"], scale, strict=True)]
    gears = int(rng.integers(4, 8))
    ratios = np.geomspace(rng.uniform(11, 15), rng.uniform(2.8, 4.0), gears) * rev**-1 * rng.uniform(0.95, 1.05, gears)
    top = float(rng.uniform(92, 110) * size)
    full_load = [[1000 * rev, top], [6000 * rev, 0.85 * top]]  # without corners, which collocation rounds off
    return {
        "kind": "accelerate",
        "vehicle": {
            "mass_kg": mass,
            "accelerated_mass_kg": mass * float(rng.uniform(1.02, 1.08)),
            "cd": float(rng.uniform(0.25, 0.45)),
            "frontal_area_m2": float(rng.uniform(1.7, 2.8)),
            "crr": float(rng.uniform(0.007, 0.015)),
            "air_density_kgpm3": float(rng.uniform(1.0, 1.3)),
            "gravity_mps2": 9.81,
            "wheel_radius_m": float(rng.uniform(0.28, 0.34)),
        },
        "engine": {
            "phi": phi,
            "speed_rpm": [1000 * rev, 6000 * rev],
            "torque_nm": [10 * size, top],
            "full_load": full_load if rng.random() < 0.5 else None,
        },
        "transmission": {"type": "gears", "ratios": sorted(ratios.tolist(), reverse=True)},
        "from_speed_mps": float(rng.uniform(5, 14)),
        "to_speed_mps": float(rng.uniform(22, 34)),
        "time_s": None,
    }
