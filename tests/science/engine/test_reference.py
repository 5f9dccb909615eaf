"""Tables of real engines beside maps of theirs, and tables that can't be used."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator

from app.science.engine.agreement import agreement
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.reference import ReferenceMap, read_reference
from app.science.errors import SignalsError

MAPS = Path(__file__).resolve().parents[4] / "shared" / "data" / "engine-maps-nrel"
PETROL_JPG = 42600.0


@pytest.fixture
def saturn() -> ReferenceMap:
    if not MAPS.exists():
        pytest.skip(f"{MAPS} is not there")
    return read_reference((MAPS / "saturn_1.9L_DOHC_95kW.csv").read_bytes(), PETROL_JPG)


def car_map(reference: ReferenceMap, factor: float, shift_rpm: float = 0.0) -> EfficiencyMap:
    rpm, nm = (a.ravel() for a in np.meshgrid(np.arange(1225.0, 5500.0, 50.0), np.arange(21.0, 160.0, 2.0)))
    efficiency = factor * reference.at(rpm - shift_rpm, nm)
    n, sd = np.full(len(rpm), 50), np.full(len(rpm), 0.01)
    return EfficiencyMap(CellGrid(), rpm, nm, n, efficiency, sd, 84.0 / efficiency, np.empty(0), np.empty(0))


def test_a_real_engines_table_is_read_without_its_padding(saturn: ReferenceMap) -> None:
    assert saturn.efficiency.max() == pytest.approx(0.345, abs=0.002)
    assert saturn.nm.max() < 170.0


def test_scale_shape_and_peak_are_told(saturn: ReferenceMap) -> None:
    found = agreement(car_map(saturn, 0.95), saturn)
    assert found is not None
    assert found.scale == pytest.approx(0.95)
    assert found.correlation == pytest.approx(1.0)
    assert (found.peak_rpm, found.peak_nm) == (0.0, 0.0)
    assert found.rmse_scaled < 1e-12 < found.rmse
    moved = agreement(car_map(saturn, 1.0, shift_rpm=400.0), saturn)
    assert moved is not None
    assert moved.peak_rpm == pytest.approx(400.0, abs=150.0)
    assert found.scale_sd < 1e-9 < moved.scale_sd < 0.02
    assert moved.correlation < 0.999


def test_a_scale_that_differs_over_the_map_is_less_sure(saturn: ReferenceMap) -> None:
    """Ten per cent of slope from end to end; the spread of single estimates tells whether the uncertainty is right."""
    rng = np.random.default_rng(5)
    flat = car_map(saturn, 1.0)
    off = []
    for _ in range(40):
        bands = rng.normal(0.0, 0.02, 12)[(flat.rpm // 500.0).astype(int)]
        found = agreement(replace(flat, efficiency=flat.efficiency * (1.0 + bands)), saturn)
        assert found is not None
        off.append((found.scale - 1.0) / found.scale_sd)
    assert 0.7 < np.sqrt(np.mean(np.square(off))) < 2.5


@pytest.mark.parametrize("transposed", [False, True])
def test_between_the_points_it_is_linear_as_the_reference_implementation_is(transposed: bool) -> None:
    """On a plane every linear interpolation is exact, up to a full-load line that differs from speed to speed."""
    points = [(s, t) for s, top in ((1000.0, 60.0), (2000.0, 100.0), (3500.0, 90.0)) for t in np.linspace(10, top, 7)]
    rpm, nm = np.array(points).T
    if transposed:
        rpm, nm = nm * 40.0, rpm / 40.0
    plane = 0.1 + rpm * 2e-5 + nm * 1e-3
    query_rpm, query_nm = np.random.default_rng(3).uniform((400.0, 5.0), (4200.0, 110.0), (500, 2)).T
    found = ReferenceMap(rpm, nm, plane).at(query_rpm, query_nm)
    known = np.isfinite(found)
    hull = np.isfinite(LinearNDInterpolator(np.column_stack([rpm, nm]), plane, rescale=True)(query_rpm, query_nm))
    np.testing.assert_allclose(found[known], (0.1 + query_rpm * 2e-5 + query_nm * 1e-3)[known], atol=2e-3)
    assert np.mean(known == hull) > 0.95


def test_a_real_engines_table_is_read_as_scipy_would(saturn: ReferenceMap) -> None:
    rng = np.random.default_rng(4)
    rpm, nm = rng.uniform(600.0, 5900.0, 2000), rng.uniform(16.0, 160.0, 2000)
    surface = LinearNDInterpolator(np.column_stack([saturn.rpm, saturn.nm]), saturn.efficiency, rescale=True)
    difference = saturn.at(rpm, nm) - surface(rpm, nm)
    assert np.nanmax(np.abs(difference)) < 0.012
    assert np.sqrt(np.nanmean(difference**2)) < 0.0015


def test_decimal_commas_between_semicolons_are_read() -> None:
    lines = ["rpm;nm;efficiency", *(f"{s};{t},5;0,{t + 10}" for s in (1000, 2000, 3000) for t in (15, 20))]
    found = read_reference("\n".join(lines).encode(), PETROL_JPG)
    assert (found.nm[0], found.efficiency[0]) == (15.5, 0.25)


def test_all_three_ways_to_tell_efficiency_agree() -> None:
    rpm, nm = np.meshgrid([2000.0, 3000.0, 4000.0], [40.0, 80.0, 120.0])
    eta = 0.2 + nm / 1000.0
    flow = nm * rpm * np.pi / 30.0 / (eta * PETROL_JPG)
    bsfc = 3.6e6 / (eta * PETROL_JPG)
    for name, values in (("efficiency", eta), ("fuel_gps", flow), ("bsfc_gpkwh", bsfc)):
        lines = [f"rpm,nm,{name}", *(f"{a},{b},{c}" for a, b, c in zip(rpm.flat, nm.flat, values.flat, strict=True))]
        found = read_reference("\n".join(lines).encode(), PETROL_JPG)
        np.testing.assert_allclose(found.efficiency, eta.ravel(), rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words", "row"),
    [
        ("rpm,nm,efficiency\n", "no row", 0),
        ("rpm,nm,power\n1000,20,3\n", "no column of efficiency", 1),
        ("speed,nm,efficiency\n1000,20,3\n", "no column of engine speed", 1),
        ("rpm,nm,efficiency\n1000,20,0.2\n1000,x,0.2\n", "'x' is not a number", 3),
        ("rpm,nm,efficiency\n1000,20,0.2\n1000,30,25\n", "efficiency of 25.00 is impossible", 3),
        ("rpm,nm,efficiency\n1000,20,0.2\n1000,30,0.25\n", "Only 2 rows", 0),
        ("rpm,nm,efficiency\n" + "".join(f"{n}000,{n}0,0.2\n" for n in range(1, 8)), "lie on no lines", 0),
    ],
)
def test_a_table_that_cannot_be_used_is_answered_with_its_row(text: str, words: str, row: int) -> None:
    with pytest.raises(SignalsError, match=words) as refused:
        read_reference(text.encode(), PETROL_JPG)
    assert refused.value.row == row
