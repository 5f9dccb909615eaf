"""Where a map speaks, where it doesn't, and what that does to a formula."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import binary_dilation, label

from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.fitting.areas import piece_around, widened
from app.science.engine.fitting.gaps import gaps
from app.science.engine.fitting.polynomial import fit
from app.science.engine.fitting.shape import fuel_shape
from app.science.engine.fitting.surface import driven_area
from tests.science.engine.fitting.engines import CELLS, TABLE_4_1, engine, part_of

MASKS = arrays(np.bool_, st.tuples(st.integers(1, 12), st.integers(1, 12)))


@given(MASKS, st.integers(0, 3))
@settings(max_examples=60, deadline=None)
def test_growing_a_mask_is_the_librarys_dilation(mask: np.ndarray, steps: int) -> None:
    theirs = binary_dilation(mask, iterations=steps) if steps else mask
    np.testing.assert_array_equal(widened(mask, steps), theirs)


@given(MASKS, st.data())
@settings(max_examples=60, deadline=None)
def test_a_piece_is_the_librarys_connected_component(mask: np.ndarray, data: st.DataObject) -> None:
    i, j = (data.draw(st.integers(0, size - 1)) for size in mask.shape)
    pieces, _ = label(mask)
    np.testing.assert_array_equal(piece_around(mask, i, j), mask & (pieces == pieces[i, j]))


def test_a_hole_in_the_map_is_named() -> None:
    whole = engine()
    hole = (whole.rpm > 2000.0) & (whole.rpm < 3000.0) & (whole.nm > 20.0) & (whole.nm < 60.0)
    (found,) = [gap for gap in gaps(part_of(whole, ~hole)) if gap.nm_range[1] > 10.0]
    assert (found.rpm_range, found.nm_range) == ((2000.0, 3000.0), (20.0, 60.0))
    assert found.words() == "2\u202f000–3\u202f000 rpm, 20–60 Nm: hardly driven"
    low = part_of(whole, whole.nm < 70.0)
    assert "above 70 Nm" in gaps(low)[0].words()
    assert gaps(part_of(whole, whole.nm > 0.0)) == gaps(whole)


def test_the_area_of_the_map_is_what_lies_near_its_cells() -> None:
    area = driven_area(engine())
    inside = area.holds(np.array([900.0, 2025.0, 3000.0, 6000.0]), np.array([5.0, 51.0, 99.0]))
    np.testing.assert_array_equal(
        inside, [[False, False, False], [False, True, False], [False, True, True], [False, False, False]]
    )


def test_the_thesis_engine_burns_concavely_below_63_nm() -> None:
    """d²(ωTφ)/dT² = ω (2 a₂ + 2 a₃ ω + 6 a₅ T) changes its sign at 62 to 63 Nm, hardly moved by engine speed."""
    shape = fuel_shape(fit(CELLS, "phi", TABLE_4_1), driven_area(engine()))
    assert shape.falling == 0.0
    assert shape.concave_below_nm == pytest.approx(62.0, abs=3.0)
    assert 0.3 < shape.concave < 0.8


def test_coarse_cells_have_coarse_gaps_and_no_surroundings() -> None:
    rpm, nm = (part.ravel() for part in np.meshgrid([1125.0, 1375.0, 1625.0, 2125.0], [50.0, 70.0, 90.0, 110.0]))
    flat, line = np.full(len(rpm), 0.3), np.array([1125.0, 2125.0])
    grid = CellGrid(250.0, 20.0, 5, 0.05, independent=True)
    sparse = EfficiencyMap(
        grid, rpm, nm, np.full(len(rpm), 9), flat, 0.1 * flat, 84.0 / flat, line, np.array([130.0, 130.0])
    )
    assert driven_area(sparse).near.sum() == len(rpm)
    largest = gaps(sparse)[0]
    assert (largest.rpm_range, largest.nm_range) == ((1750.0, 2000.0), (20.0, 140.0))
    assert largest.words() == "1\u202f750–2\u202f000 rpm, at any torque: hardly driven"
