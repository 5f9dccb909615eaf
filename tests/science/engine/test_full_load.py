"""The full load out of moments whose ceiling is known: no bias from noise, and no ceiling where there was none."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.full_load import FullLoad, full_load_curve
from app.science.engine.moments import MomentSums, merge_moments, moments_of
from app.science.engine.points import OperatingPoints
from app.science.vehicle.model import Vehicle
from tests.synthetic import points_at

STEP_S = 0.05
RADPS_PER_RPM = np.pi / 30.0


def ceiling_nm(rpm: np.ndarray) -> np.ndarray:
    """A curve of the usual shape, best at 3000 rpm."""
    return 110.0 - 25.0 * ((rpm - 3000.0) / 2000.0) ** 2


def drive(pedals: np.ndarray, *, seed: int = 1, noise: float = 0.03, rises: bool = True) -> OperatingPoints:
    """Sweep from 1200 to 4800 rpm in nine seconds once for each pedal, or hold 36 engine speeds a quarter second each.

    Fuel is P = 4 kW + power / 0.4 and known to 0.3 %; torque errs by ``noise``, the same for half a second.
    """
    rng = np.random.default_rng(seed)
    parts = []
    for number, pedal in enumerate(pedals):
        t = np.arange(0.0, 9.0, STEP_S)
        rpm = 1200.0 + 400.0 * t if rises else 4800.0 - 400.0 * t
        nm = pedal * ceiling_nm(rpm)
        power = nm * rpm * RADPS_PER_RPM
        fuel = (4000.0 + power / 0.4) * (1.0 + 0.003 * rng.standard_normal(len(t)))
        error = 1.0 + noise * np.repeat(rng.standard_normal(len(t) // 10), 10)
        parts.append(np.column_stack((t + 20.0 * number, rpm, nm * error, power * error, fuel)))
    t, rpm, nm, power, fuel = np.concatenate(parts).T
    return OperatingPoints(t, rpm, nm, power, fuel, power / fuel, np.full(len(t), 0.01), "observer")


def curve(*trips: OperatingPoints) -> FullLoad:
    return full_load_curve(merge_moments(moments_of(trip) for trip in trips))


def test_noise_does_not_lift_the_full_load() -> None:
    pedals = np.concatenate((np.ones(12), np.random.default_rng(2).uniform(0.3, 0.85, 30)))
    found = curve(drive(pedals, noise=0.05))
    error = found.nm[found.reached] / ceiling_nm(found.rpm[found.reached]) - 1.0
    assert found.reached.mean() > 0.9
    assert abs(error.mean()) < 0.01
    assert np.abs(error).max() < 0.04
    deviations = np.abs(found.nm - ceiling_nm(found.rpm))[found.reached] / found.sd[found.reached]
    assert np.mean(deviations < 2.0) > 0.9


def test_a_driver_who_stops_anywhere_short_reaches_nothing() -> None:
    """Held all the way through, forty pedals can pile up by chance; that must stay rare."""
    fooled = 0
    for seed in range(20):
        found = curve(drive(np.random.default_rng(seed).uniform(0.3, 0.9, 40), seed=seed))
        fooled += found.reached.mean() > 0.3
        assert np.all(found.nm < 1.03 * ceiling_nm(found.rpm))
    assert fooled <= 2


def test_cruising_at_one_load_is_no_full_load() -> None:
    found = curve(drive(np.full(12, 0.5), rises=False))
    assert not found.reached.any()
    assert found.nm == pytest.approx(0.5 * ceiling_nm(found.rpm), rel=0.04)


def test_more_seen_on_both_sides_makes_a_reached_column_a_bound() -> None:
    points = drive(np.concatenate((np.ones(8), np.full(20, 0.6))))
    floored = points.t_s < 8 * 20.0
    middle = (points.engine_speed_rpm > 2700.0) & (points.engine_speed_rpm < 2900.0)
    keep = ~(floored & middle)
    arrays = {f.name: getattr(points, f.name)[keep] for f in fields(points) if f.name != "torque_source"}
    found = curve(OperatingPoints(**arrays, torque_source="observer"))
    inside = (found.rpm > 2700.0) & (found.rpm < 2900.0)
    assert not found.reached[inside].any()
    assert found.reached[~inside].mean() > 0.9
    assert found.nm[inside] == pytest.approx(ceiling_nm(found.rpm[inside]), rel=0.03)


def test_trips_in_any_order_and_left_out_again() -> None:
    trips = [moments_of(drive(np.full(3, pedal), seed=seed)) for seed, pedal in enumerate((1.0, 0.7, 0.4, 0.99))]
    together, backwards = merge_moments(trips), merge_moments(reversed(trips))
    for field in fields(MomentSums):
        np.testing.assert_allclose(getattr(together, field.name), getattr(backwards, field.name), rtol=1e-12)
    halves = merge_moments([merge_moments(trips[:2]), merge_moments(trips[2:])])
    np.testing.assert_allclose(halves.torque_sum, together.torque_sum, rtol=1e-12)
    assert np.array_equal(merge_moments(trips[:1]).k, trips[0].k)


def test_moments_agree_with_a_loop() -> None:
    points = drive(np.array([0.8]))
    sums = moments_of(points)
    rows: dict[int, list[int]] = {}
    for at, rpm in enumerate(points.engine_speed_rpm):
        rows.setdefault(int(rpm // 100.0), []).append(at)
    assert sums.moments.sum() == len(rows)
    for column, at in rows.items():
        charge = np.mean(points.fuel_power_w[at] / (points.engine_speed_rpm[at] * RADPS_PER_RPM))
        place = np.flatnonzero(sums.i == column)
        assert sums.k[place] == [int(np.floor(100.0 * np.log(charge)))]
        assert sums.torque_sum[place] == pytest.approx([points.torque_nm[at].mean()])


def test_load_rising_at_one_engine_speed_is_many_moments() -> None:
    """A minute from 30 to 90 Nm at 3010 rpm: the bound is near the most, not the mean; and it is only a bound."""
    t = np.arange(0.0, 60.0, STEP_S)
    points = replace(points_at(np.full(len(t), 3010.0), np.linspace(30.0, 90.0, len(t))), t_s=t)
    found = curve(points)
    assert moments_of(points).moments.sum() >= 20
    assert found.nm == pytest.approx([88.0], abs=2.0)
    assert not found.reached.any()


def test_cells_above_a_reached_full_load_are_not_trusted() -> None:
    points = drive(np.ones(150), noise=0.08)
    found = curve(points)
    sums = accumulate(points, CellGrid())
    bare, known = build_map(sums, CellGrid(), Vehicle()), build_map(sums, CellGrid(), Vehicle(), found)
    above = bare.nm > 1.1 * ceiling_nm(bare.rpm)
    assert np.isfinite(bare.efficiency[above]).any()
    assert not np.isfinite(known.efficiency[above & (bare.rpm < 4700.0) & (bare.rpm > 1300.0)]).any()
    assert known.full_load_reached is not None
    assert known.full_load_reached.sum() > 30
    assert bare.full_load_reached is not None
    assert not bare.full_load_reached.any()


def test_nothing_seen_is_an_empty_curve() -> None:
    points = drive(np.array([0.8]))
    empty = replace(points, **{f.name: np.empty(0) for f in fields(points) if f.name != "torque_source"})
    assert len(curve(empty).rpm) == 0
    assert len(full_load_curve(merge_moments([])).rpm) == 0
