"""The drive found by formulas against a search that looks the maps themselves up."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from app.science.arrays import FloatArray
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from tests.science.optimal.documents import SIX_GEARS, SMART, TABLE_4_1, thesis

RPM, NM = np.linspace(1000.0, 6000.0, 11), np.linspace(10.0, 100.0, 10)
SMOOTH = np.outer(RPM / 6000.0, NM / 100.0) ** 2
BUMPY = 0.02 + SMOOTH * (0.6 + 0.4 * np.cos(RPM / 700.0)[:, None] * np.cos(NM / 13.0))
SPEEDS, TORQUES = np.linspace(10.0, 100.0 / 3.6, 801), np.linspace(10.0, 100.0, 501)


def least_cost_j(table: FloatArray, weight_jpg: float) -> float:
    """Return the least of fuel and weighted emission from 36 to 100 km/h in free time, torque by torque."""
    look_up = RegularGridInterpolator((RPM, NM), table)
    least = np.full(SPEEDS.shape, np.inf)
    resisted = 0.5 * 1.2 * 0.39 * 1.93 * SPEEDS**2 + 920.0 * 0.010 * 9.805
    one, w1, t1, wt, w2, t2 = TABLE_4_1["phi"]
    for ratio in SIX_GEARS["ratios"]:
        omega = SPEEDS * ratio / SMART["wheel_radius_m"]
        rpm = omega * 30.0 / np.pi
        rows = np.flatnonzero((rpm >= 1000.0) & (rpm <= 6000.0))
        w, t = np.meshgrid(omega[rows], TORQUES, indexing="ij")
        power = w * t * (one + w1 * w + t1 * t + wt * w * t + w2 * w**2 + t2 * t**2)
        power += weight_jpg * look_up((np.clip(w * 30.0 / np.pi, 1000.0, 6000.0), t))
        gain = (w * t / SPEEDS[rows, None] - resisted[rows, None]) / 948.0
        cost = np.where(gain > 0.0, power / np.where(gain > 0.0, gain, 1.0), np.inf)
        least[rows] = np.minimum(least[rows], cost.min(axis=1))
    return float(np.trapezoid(least, SPEEDS))


@pytest.mark.parametrize(("table", "worse"), [(SMOOTH, 5e-5), (BUMPY, 3e-4)], ids=["smooth", "bumpy"])
def test_formulas_hardly_cost_anything(table: FloatArray, worse: float) -> None:
    emissions = {"nox": {"rpm": RPM.tolist(), "nm": NM.tolist(), "gps": table.tolist()}}
    cost = {"weights": {"fuel": 1.0, "nox": 2e4}, "emissions": emissions}
    found = solve(read_problem(thesis(cost=cost))).document()
    by_map = found["fuel_energy_j"] + 2e4 * found["emissions_g"]["nox"]
    assert found["cost"]["weighted_by_map_j"] == pytest.approx(by_map, rel=1e-12)
    assert -2e-5 < by_map / least_cost_j(table, 2e4) - 1.0 < worse
    assert any("misses it by" in line for line in found["warnings"]) == (table is BUMPY)
    assert not any(line.startswith("Fuel power") for line in found["warnings"])
