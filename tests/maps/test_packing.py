"""Sums survive being packed."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.maps.packing import pack_sums, unpack_moments, unpack_sums
from app.science.engine.cells import EMPTY, accumulate
from app.science.engine.efficiency_map import CellGrid, CellSums
from app.science.engine.moments import NO_MOMENTS, MomentSums, moments_of
from tests.synthetic import random_points


def same(one: CellSums | MomentSums, other: CellSums | MomentSums) -> bool:
    return all(np.array_equal(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))


@given(st.integers(0, 500), st.integers(0, 2**32 - 1))
def test_packing_loses_nothing(count: int, seed: int) -> None:
    points = replace(random_points(count, seed), torque_source="ecu")
    sums, moments = accumulate(points, CellGrid()), moments_of(points)
    packed = pack_sums(sums, moments)
    assert same(unpack_sums(packed), sums)
    assert same(unpack_moments(packed), moments)


def test_no_cells_at_all_are_packed_too() -> None:
    packed = pack_sums(EMPTY, NO_MOMENTS)
    assert same(unpack_sums(packed), EMPTY)
    assert same(unpack_moments(packed), NO_MOMENTS)
