"""Decimation keeps what an eye would see."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.figures.decimate import band, even_indices, minmax_indices

VALUES = st.lists(st.one_of(st.floats(-1e6, 1e6), st.just(float("nan"))), min_size=1, max_size=600)


@given(VALUES, st.integers(8, 60))
def test_the_budget_is_kept_and_both_ends_stay(values: list[float], points: int) -> None:
    kept = minmax_indices(np.array(values), points)
    assert len(kept) <= max(points, 8)
    assert np.all(np.diff(kept) > 0)
    assert kept[0] == 0
    assert kept[-1] == len(values) - 1


@given(VALUES, st.integers(8, 60))
def test_the_extremes_of_every_window_are_kept(values: list[float], points: int) -> None:
    array = np.array(values)
    kept = minmax_indices(array, points)
    if len(kept) == len(array):
        return
    known = np.isfinite(array)
    width = -(-len(array) // ((points - 2) // (2 if known.all() else 3)))
    for start in range(0, len(array), width):
        window = array[start : start + width]
        chosen = array[kept[(kept >= start) & (kept < start + width)]]
        if np.isfinite(window).any():
            assert np.nanmin(chosen) == np.nanmin(window)
            assert np.nanmax(chosen) == np.nanmax(window)


@given(VALUES, st.integers(8, 60), st.data())
def test_a_gap_as_long_as_a_window_still_interrupts_the_curve(
    values: list[float], points: int, data: st.DataObject
) -> None:
    array = np.array(values)
    width = -(-len(array) // ((max(points, 8) - 2) // 3))
    start = data.draw(st.integers(0, max(len(array) - width, 0)))
    array[start : start + width] = np.nan
    kept = minmax_indices(array, points)
    assert np.isnan(array[kept[(kept >= start) & (kept < start + width)]]).any()


def test_a_spike_of_one_sample_in_a_million_survives() -> None:
    values = np.sin(np.arange(1_000_000) / 50_000.0)
    values[654_321] = 40.0
    kept = minmax_indices(values, 4000)
    assert len(kept) <= 4000
    assert 654_321 in kept


def test_everything_is_kept_when_it_fits() -> None:
    assert minmax_indices(np.arange(100.0), 100).tolist() == list(range(100))


@given(st.lists(st.floats(-100, 100), min_size=1, max_size=300), st.integers(1, 40), st.integers(0, 299))
def test_a_reduced_band_covers_the_whole_one(values: list[float], windows: int, gap: int) -> None:
    middle = np.array(values)
    middle[gap : gap + 1] = np.nan
    t = np.arange(len(middle), dtype=np.float64)
    reduced = band(t, middle - 1.0, middle + 1.0, windows)
    assert len(reduced.t_s) <= max(windows, 1)
    if np.isfinite(middle).any():
        assert np.nanmin(reduced.lower) == np.nanmin(middle) - 1.0
        assert np.nanmax(reduced.upper) == np.nanmax(middle) + 1.0
    width = -(-len(t) // windows)
    for row, start in enumerate(range(0, len(t), width)):
        window = middle[start : start + width]
        if len(reduced.t_s) < len(t) and np.isfinite(window).any():
            assert reduced.lower[row] == np.nanmin(window) - 1.0


@pytest.mark.parametrize(("count", "most"), [(0, 5), (1, 5), (5, 5), (1000, 7)])
def test_an_even_choice_has_both_ends(count: int, most: int) -> None:
    kept = even_indices(count, most)
    assert len(kept) == min(count, most)
    if count:
        assert (kept[0], kept[-1]) == (0, count - 1)
        assert np.ptp(np.diff(kept)) <= 1 if len(kept) > 1 else True
