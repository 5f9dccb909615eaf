"""Cells, their sums and what the map says, against Table 4.1 and slow references."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import uniform_filter

from app.science.engine.accuracy import map_error
from app.science.engine.cells import EMPTY, accumulate, build_map, coarsen, merge
from app.science.engine.document import map_document, read_map_document
from app.science.engine.efficiency_map import CellGrid, CellSums, EfficiencyMap, Idle
from app.science.engine.operating_line import optimal_operating_line
from app.science.engine.points import OperatingPoints
from app.science.engine.raster import confidence, raster, smoothed
from app.science.engine.reading import coverage, peak
from app.science.engine.resolution import resolve
from app.science.errors import ScienceError
from app.science.vehicle.model import Vehicle
from tests.synthetic import points_at, random_points, table_4_1

GRID = CellGrid()
CAR = Vehicle()


def map_of(points: OperatingPoints, grid: CellGrid = GRID) -> EfficiencyMap:
    return build_map(accumulate(points, grid), grid, CAR)


def assert_same(a: CellSums, b: CellSums) -> None:
    for field in fields(CellSums):
        np.testing.assert_allclose(getattr(a, field.name), getattr(b, field.name), rtol=1e-12)


def select(points: OperatingPoints, chosen: slice) -> OperatingPoints:
    arrays = {f.name: getattr(points, f.name)[chosen] for f in fields(points) if f.name != "torque_source"}
    return OperatingPoints(**arrays, torque_source=points.torque_source)


def test_sums_agree_with_a_loop() -> None:
    points = random_points(3000)
    sums = accumulate(points, GRID)
    slow: dict[tuple[int, int], list[float]] = {}
    for k in range(len(points)):
        cell = (int(points.engine_speed_rpm[k] // 50.0), int(points.torque_nm[k] // 2.0))
        row = slow.setdefault(cell, [0, 0.0, 0.0, 0.0, 0.0])
        e = points.efficiency[k]
        for at, value in enumerate((1, e, e * e, points.power_w[k], points.fuel_power_w[k])):
            row[at] += value
    assert list(zip(sums.i.tolist(), sums.j.tolist(), strict=True)) == sorted(slow)
    expected = np.array([slow[cell] for cell in sorted(slow)])
    names = ("n", "efficiency_sum", "efficiency_squared_sum", "power_sum_w", "fuel_power_sum_w")
    for at, name in enumerate(names):
        np.testing.assert_allclose(getattr(sums, name), expected[:, at], rtol=1e-12)


@given(st.lists(st.integers(0, 400), min_size=1, max_size=5), st.integers(0, 2**16))
def test_merging_trips_in_any_order_equals_one_long_trip(sizes: list[int], seed: int) -> None:
    points = random_points(sum(sizes), seed)
    edges = np.cumsum([0, *sizes])
    trips = [accumulate(select(points, slice(a, b)), GRID) for a, b in pairwise(edges)]
    whole = accumulate(points, GRID)
    assert_same(merge(trips), whole)
    assert_same(merge(reversed(trips)), whole)
    assert_same(merge([merge(trips[:1]), merge(trips[1:])]), whole)
    assert_same(merge(trips[1:]), accumulate(select(points, slice(sizes[0], None)), GRID))


def test_merging_nothing_is_an_empty_map() -> None:
    assert_same(merge([]), EMPTY)
    empty = build_map(merge([]), GRID, CAR)
    assert len(empty.n) == 0
    assert peak(empty) is None
    assert coverage(empty, 850.0) == 0.0
    assert len(optimal_operating_line(empty).power_w) == 0
    assert np.isnan(map_error(empty, table_4_1).rmse)


def test_exact_points_give_the_exact_map_up_to_averaging_within_a_cell() -> None:
    """Cells half as wide and tall, with as many points each, halve what is left."""
    wide = map_error(map_of(random_points(50_000)), table_4_1)
    narrow = map_error(map_of(random_points(200_000), CellGrid(25.0, 1.0)), table_4_1)
    assert wide.cells > 2500
    assert wide.rmse < 4e-4
    assert narrow.rmse == pytest.approx(wide.rmse / 2, rel=0.15)
    assert abs(wide.bias) < 2e-5


def test_one_point_per_cell_centre_gives_no_error_at_all() -> None:
    rpm, nm = np.meshgrid(np.arange(1025.0, 5000.0, 50.0), np.arange(31.0, 100.0, 2.0))
    points = points_at(np.repeat(rpm.ravel(), 10), np.repeat(nm.ravel(), 10))
    error = map_error(map_of(points), table_4_1)
    assert error.cells == rpm.size
    assert error.worst < 1e-12


def test_noise_in_the_fuel_power_does_not_lift_the_map() -> None:
    rng = np.random.default_rng(5)
    points = points_at(np.full(20_000, 3025.0), np.full(20_000, 61.0))
    fuel = points.fuel_power_w * (1 + 0.1 * rng.standard_normal(20_000))
    noisy = replace(points, fuel_power_w=fuel, efficiency=points.power_w / fuel)
    truth = points.efficiency[0]
    assert abs(map_of(noisy).efficiency[0] / truth - 1) < 0.002
    assert noisy.efficiency.mean() / truth - 1 > 0.008


def test_error_figures_of_a_map_by_hand() -> None:
    points = points_at(np.repeat([2025.0, 3025.0], [10, 30]), np.repeat([41.0, 61.0], [10, 30]))
    error = map_error(map_of(points), lambda r, t: table_4_1(r, t) + np.where(r < 2500, -0.03, 0.01))
    assert error.rmse == pytest.approx(np.sqrt((0.03**2 + 0.01**2) / 2))
    assert error.rmse_weighted == pytest.approx(np.sqrt((10 * 0.03**2 + 30 * 0.01**2) / 40))
    assert error.bias == pytest.approx(0.01)
    assert error.worst == pytest.approx(0.03)


@pytest.mark.parametrize(("count", "spread", "trusted"), [(10, 0.049, True), (9, 0.0, False), (10, 0.051, False)])
def test_a_cell_needs_enough_points_that_agree(count: int, spread: float, trusted: bool) -> None:
    points = points_at(np.full(count, 2025.0), np.full(count, 41.0))
    sign = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
    scale = np.sqrt((count - 1) / count)
    points = replace(points, efficiency=0.3 + sign * spread * scale)
    result = map_of(points)
    if count % 2 == 0:
        assert result.sd[0] == pytest.approx(spread)
    assert bool(np.isfinite(result.efficiency[0])) == trusted
    assert bool(np.isfinite(result.bsfc_gpkwh[0])) == trusted


def test_consumption_of_petrol_by_hand() -> None:
    """1 kWh at 35 % takes 10.286 MJ = 0.32143 l of petrol at 32 MJ/l, which weighs 239.46 g at 0.745 kg/l."""
    points = replace(
        points_at(np.full(10, 2025.0), np.full(10, 41.0)), power_w=np.full(10, 35.0), fuel_power_w=np.full(10, 100.0)
    )
    assert map_of(points).bsfc_gpkwh[0] == pytest.approx(239.46, abs=0.005)


@pytest.mark.parametrize("wrong", [0.75, -0.2])
def test_an_efficiency_that_no_engine_has_is_refused_with_what_to_check(wrong: float) -> None:
    points = points_at(np.repeat([2025.0, 3025.0], 12), np.repeat([41.0, 61.0], 12))
    power = np.where(points.engine_speed_rpm > 3000.0, wrong * points.fuel_power_w, points.power_w)
    result = map_of(replace(points, power_w=power, efficiency=power / points.fuel_power_w))
    assert np.isfinite(result.efficiency).tolist() == [True, False]
    assert len(result.warnings) == 1
    assert f"1 cell has an efficiency that no engine has ({100 * wrong:.0f} %;" in result.warnings[0]
    assert "injectors' flow" in result.warnings[0]
    assert map_of(points).warnings == ()


def test_full_load_is_the_highest_trusted_torque_per_column() -> None:
    rpm = np.repeat([2025.0, 2025.0, 2025.0, 2075.0], [10, 12, 3, 10])
    nm = np.repeat([31.0, 71.0, 95.0, 81.0], [10, 12, 3, 10])
    result = map_of(points_at(rpm, nm))
    assert result.full_load_rpm.tolist() == [2025.0, 2075.0]
    assert result.full_load_nm.tolist() == [71.0, 81.0]


def test_a_narrow_dip_of_the_full_load_is_closed_and_a_wide_one_kept() -> None:
    rpm = np.arange(1025.0, 3000.0, 50.0)
    torque = np.full(len(rpm), 91.0)
    torque[(rpm > 1400) & (rpm < 1600)] = 31.0
    torque[(rpm > 2000) & (rpm < 2600)] = 41.0
    missing = (rpm > 1700) & (rpm < 1800)
    result = map_of(points_at(np.repeat(rpm[~missing], 10), np.repeat(torque[~missing], 10)))
    assert result.full_load_rpm.tolist() == rpm.tolist()
    expected = np.where((rpm > 2000) & (rpm < 2600), 41.0, 91.0)
    assert result.full_load_nm.tolist() == expected.tolist()


def test_peak_is_the_papers() -> None:
    """Minimum of φ: 2.567, that is 38.96 %, at 3867 rpm and 92.9 Nm."""
    best = peak(map_of(random_points(200_000)))
    assert best is not None
    assert best.efficiency == pytest.approx(0.3896, abs=0.001)
    assert best.rpm == pytest.approx(3867.0, abs=150.0)
    assert best.nm == pytest.approx(92.9, abs=4.0)
    assert best.bsfc_gpkwh == pytest.approx(3.6e9 * 0.745 / 32.0e6 / best.efficiency)


def test_a_lone_lucky_cell_is_not_the_peak() -> None:
    points = random_points(100_000)
    lucky = (points.engine_speed_rpm // 50 == 30) & (points.torque_nm // 2 == 12)
    assert lucky.sum() >= 10
    fuel = np.where(lucky, points.power_w / 0.42, points.fuel_power_w)
    best = peak(map_of(replace(points, fuel_power_w=fuel, efficiency=points.power_w / fuel)))
    assert best is not None
    assert best.rpm == pytest.approx(3867.0, abs=200.0)


def test_smoothing_agrees_with_a_box_filter() -> None:
    cells = raster(map_of(random_points(30_000)))
    trusted = np.isfinite(cells.efficiency)
    assert 0.2 < trusted.mean() < 0.8
    weight = uniform_filter(trusted.astype(float), 5, mode="constant")
    around = smoothed(cells)
    for values, answer in ((cells.efficiency, around.efficiency), (cells.sd**2, around.sd**2)):
        expected = uniform_filter(np.where(trusted, values, 0.0), 5, mode="constant")[trusted] / weight[trusted]
        np.testing.assert_allclose(answer[trusted], expected, rtol=1e-9)
    assert np.isnan(around.efficiency[~trusted]).all()
    np.testing.assert_array_equal(np.isfinite(around.filled), trusted | (weight >= 0.5 - 1e-9))
    np.testing.assert_array_equal(around.supported, trusted & (weight >= 0.2 - 1e-9))


def test_confidence_rises_with_points_and_falls_with_scatter() -> None:
    cells = raster(map_of(random_points(30_000)))
    trust = confidence(cells)
    assert np.all(trust[np.isnan(cells.efficiency)] == 0.0)
    assert np.all((trust >= 0.0) & (trust < 1.0))
    more = confidence(replace(cells, n=2 * cells.n))
    worse = confidence(replace(cells, sd=cells.sd + 0.01))
    known = trust > 0
    assert np.all(more[known] > trust[known])
    assert np.all(worse[known] < trust[known])


def test_coverage_of_a_full_and_a_half_map() -> None:
    rpm, nm = (x.ravel() for x in np.meshgrid(np.arange(1025.0, 4000.0, 50.0), np.arange(1.0, 90.0, 2.0)))
    full = map_of(points_at(np.repeat(rpm, 10), np.repeat(nm, 10)))
    assert coverage(full, 1000.0) == 1.0
    lower = (np.arange(len(rpm)) % 2 == 0) | (nm > 88)
    half = coverage(map_of(points_at(np.repeat(rpm[lower], 10), np.repeat(nm[lower], 10))), 1000.0)
    assert half == pytest.approx(0.5, abs=0.02)


def test_operating_line_gives_away_little_at_every_power() -> None:
    line = optimal_operating_line(map_of(random_points(200_000)))
    np.testing.assert_allclose(line.rpm * line.nm * np.pi / 30, line.power_w, rtol=1e-9)
    assert np.all(np.diff(line.power_w) > 0)
    speeds = np.linspace(1200.0, 5000.0, 2000)
    for power, rpm, nm in zip(line.power_w, line.rpm, line.nm, strict=True):
        torque = power / (speeds * np.pi / 30)
        allowed = (torque >= 20.0) & (torque <= 100.0)
        assert table_4_1(rpm, nm) > table_4_1(speeds[allowed], torque[allowed]).max() - 0.004


def test_coarser_cells_hold_the_same_sums() -> None:
    points = random_points(5000)
    coarse = CellGrid(250.0, 20.0)
    assert_same(coarsen(accumulate(points, GRID), 5, 10), accumulate(points, coarse))


def test_few_points_are_shown_in_coarser_cells() -> None:
    assert resolve(accumulate(random_points(100_000), GRID), GRID).grid == GRID
    few = resolve(accumulate(random_points(170), GRID), GRID)
    assert few.grid.rpm == 500.0
    assert few.sums.n.sum() == 170
    assert resolve(EMPTY, GRID).grid == GRID


def test_the_document_says_the_map_and_reads_back() -> None:
    idle = Idle(820.0, 8.0, 3500.0, 150.0, 0.39, 61.0)
    original = replace(map_of(random_points(20_000)), idle=idle, warnings=("Check the mass.",))
    text = json.dumps(map_document(original, {"trips": ["a"]}), allow_nan=False)
    document = json.loads(text)
    assert document["provenance"] == {"trips": ["a"]}
    assert document["cell"]["rpm"] == 50.0
    assert document["idle"]["litres_per_hour"] == 0.39
    assert document["full_load_reached"] == [False] * len(document["full_load"])
    line = document["operating_line"]
    assert line[10]["bsfc_gpkwh"] * line[10]["efficiency"] == pytest.approx(3.6e9 * 0.745 / 32.0e6)
    untrusted = [c for c in document["cells"] if c["efficiency"] is None]
    assert len(untrusted) == np.isnan(original.efficiency).sum()
    assert document["best"]["efficiency"] == pytest.approx(peak(original).efficiency)  # type: ignore[union-attr]  # trusted cells exist
    back = read_map_document(document)
    assert back.grid == original.grid
    for field in fields(EfficiencyMap):
        if field.name != "grid":
            np.testing.assert_array_equal(getattr(back, field.name), getattr(original, field.name))


def test_the_smallest_document_of_the_contract_reads() -> None:
    cell = {"rpm": 2025, "nm": 41, "n": 12, "efficiency": 0.3}
    read = read_map_document({"cell": {"rpm": 50, "nm": 2}, "cells": [cell]})
    assert read.efficiency.tolist() == [0.3]
    assert np.isnan(read.sd[0])
    assert len(read.full_load_rpm) == 0


@pytest.mark.parametrize(
    "broken",
    [{}, {"cell": {"rpm": 50}, "cells": []}, {"cell": {"rpm": 50, "nm": 2}, "cells": [{"rpm": "much"}]}, {"cell": 3}],
)
def test_a_broken_document_is_refused_with_what_it_needs(broken: dict[str, object]) -> None:
    with pytest.raises(ScienceError, match=r"needs cell\.rpm"):
        read_map_document(broken)
