"""Carried beliefs that are no covariances are begun with as the nearest ones."""

from __future__ import annotations

import numpy as np

from app.science.battery.kalman.belief import possible


def test_a_covariance_stays_as_it_is() -> None:
    root = np.random.default_rng(0).standard_normal((7, 7)) * np.logspace(-4, 0, 7)[:, None]
    covariance = root @ root.T
    np.testing.assert_array_equal(possible(covariance), covariance)
    nothing = np.zeros((7, 7))
    np.testing.assert_array_equal(possible(nothing), nothing)


def test_a_matrix_that_is_none_becomes_the_nearest_one() -> None:
    scale = np.array([1e-2, 3e-2, 1e-3])
    almost = np.array([[1.0, 0.9, 0.9], [0.9, 1.0, -0.2], [0.9, -0.2, 1.0]]) * np.outer(scale, scale)
    assert np.linalg.eigvalsh(almost).min() < 0.0
    made = possible(almost)
    assert np.linalg.eigvalsh(made / np.outer(scale, scale)).min() > 0.0
    np.testing.assert_allclose(np.sqrt(np.diag(made)), scale, rtol=0.2)
