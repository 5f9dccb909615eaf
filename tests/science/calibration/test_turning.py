"""Turns as vectors and matrices, against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from app.science.calibration.turning import turn_matrix, turn_vector

vectors = st.lists(st.floats(-1.8, 1.8), min_size=3, max_size=3).map(np.array)


@given(vectors)
def test_a_vector_turns_as_scipy_says(vector: np.ndarray) -> None:
    np.testing.assert_allclose(turn_matrix(vector), Rotation.from_rotvec(vector).as_matrix(), atol=1e-14)


@given(vectors)
def test_a_matrix_gives_its_vector_back(vector: np.ndarray) -> None:
    np.testing.assert_allclose(turn_matrix(turn_vector(turn_matrix(vector))), turn_matrix(vector), atol=1e-12)
    if np.linalg.norm(vector) < 3.1:
        np.testing.assert_allclose(turn_vector(turn_matrix(vector)), vector, atol=1e-9)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8)])
def test_half_a_turn_is_found_too(axis: tuple[float, float, float]) -> None:
    half = turn_vector(Rotation.from_rotvec(np.pi * np.array(axis)).as_matrix())
    assert float(np.linalg.norm(half)) == pytest.approx(np.pi)
    assert abs(float(half @ np.array(axis))) == pytest.approx(np.pi)
    assert not turn_vector(np.eye(3)).any()
