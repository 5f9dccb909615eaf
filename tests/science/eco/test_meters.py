"""The display's meters on drives whose energies are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.eco.alongside import Along
from app.science.eco.meters import STEP_S, WINDOW_S, Meters, meters
from tests.science.eco.trips import CAR, states

T = np.arange(0.0, 60.0, 0.1)
FULL = int(2 * WINDOW_S / STEP_S)
"""By then the window holds nothing of the start."""


def shown(
    speed_mps: FloatArray, accel_mps2: float, pitch_rad: float = 0.0, *, gear: int = 4, along: Along | None = None
) -> Meters:
    driven = states(T, speed_mps, np.full(len(T), accel_mps2), np.full(len(T), gear), pitch_rad)
    return meters(driven | {"thrust_n_sd": np.full(len(T), 50.0)}, CAR, along)


def test_a_steady_climb_stores_height_at_the_rate_of_the_climb() -> None:
    v, pitch = 20.0, 0.04
    found = shown(np.full(len(T), v), 0.0, pitch)
    driven = states(T, np.full(len(T), v), np.zeros(len(T)), np.full(len(T), 4), pitch)
    fuel = driven["fuel_power_w"][-1]
    assert found.to_height[FULL:] == pytest.approx(CAR.mass_kg * CAR.gravity_mps2 * np.sin(pitch) * v / fuel, rel=1e-9)
    assert found.efficiency[FULL:] == pytest.approx(driven["thrust_n"][-1] * v / fuel, rel=1e-9)
    assert found.to_speed[FULL:] == pytest.approx(0.0, abs=1e-9)
    assert found.efficiency_sd[FULL:] == pytest.approx(50.0 * v / fuel, rel=1e-9)


def test_kinetic_energy_counts_while_the_car_speeds_up() -> None:
    rate = 0.3
    v = 10.0 + rate * T
    found, end = shown(v, rate), FULL
    driven = states(T, v, np.full(len(T), rate), np.full(len(T), 4), 0.0)
    window = (found.t_s[end] >= T) & (found.t_s[end] - WINDOW_S <= T)
    gained = 0.5 * CAR.accelerated_mass_kg(4) * float(np.ptp(v[window] ** 2))
    fuel = float(np.trapezoid(driven["fuel_power_w"][window], T[window]))
    assert found.to_speed[end] == pytest.approx(gained / fuel, rel=1e-3)
    split = found.to_speed + found.to_height + found.to_resistance
    assert split == pytest.approx(found.efficiency, rel=1e-12, nan_ok=True)


def test_where_the_fuel_is_cut_there_is_no_efficiency() -> None:
    found = shown(25.0 - 0.2 * T, -0.2, -0.06)
    assert np.isnan(found.efficiency[FULL:]).all()


def test_the_target_is_the_best_drives_speed_at_the_same_place() -> None:
    rows = 20
    zero = {name: np.zeros(rows) for name in Along.__dataclass_fields__}
    t = np.linspace(10.0, 30.0, rows)
    best = {"t_s": t, "best_speed_mps": 0.5 * t, "best_gear": np.where(t < 20.0, 3.0, 5.0), "best_costate": 100.0 * t}
    found = shown(np.full(len(T), 20.0), 0.0, along=Along(**zero | best))
    inside = (found.t_s >= 10.0) & (found.t_s <= 30.0)
    assert found.target_mps[inside] == pytest.approx(0.5 * found.t_s[inside])
    assert found.costate[inside] == pytest.approx(100.0 * found.t_s[inside])
    assert set(found.best_gear[inside]) == {3.0, 5.0}
    assert np.isnan(found.target_mps[~inside]).all()
