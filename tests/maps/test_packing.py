"""Sums survive being packed."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.maps.packing import pack_sums, unpack_sums
from app.science.engine.cells import EMPTY, accumulate
from app.science.engine.efficiency_map import CellGrid, CellSums
from tests.synthetic import random_points


def same(one: CellSums, other: CellSums) -> bool:
    return all(np.array_equal(getattr(one, f.name), getattr(other, f.name)) for f in fields(CellSums))


@given(st.integers(0, 500), st.integers(0, 2**32 - 1))
def test_packing_loses_nothing(count: int, seed: int) -> None:
    sums = accumulate(random_points(count, seed), CellGrid())
    assert same(unpack_sums(pack_sums(sums)), sums)


def test_no_cells_at_all_are_packed_too() -> None:
    assert same(unpack_sums(pack_sums(EMPTY)), EMPTY)
