"""Tables of real engines beside maps of theirs, and tables that can't be used."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.reference import ReferenceMap, agreement, read_reference
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
    assert moved.correlation < 0.999


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
    ],
)
def test_a_table_that_cannot_be_used_is_answered_with_its_row(text: str, words: str, row: int) -> None:
    with pytest.raises(SignalsError, match=words) as refused:
        read_reference(text.encode(), PETROL_JPG)
    assert refused.value.row == row
