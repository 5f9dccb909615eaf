"""Chance by formulas that need no tables, beside SciPy's distributions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from app.science.engine.significance import told_apart, two_sided_chance

NORMALISED = np.array([-8.0, -3.0, -1.0, 0.0, 0.5, 2.0, 4.5])


def test_chance_is_that_of_the_normal_distribution() -> None:
    np.testing.assert_allclose(two_sided_chance(NORMALISED), 2.0 * stats.norm.sf(np.abs(NORMALISED)), rtol=1e-12)


@pytest.mark.parametrize("freedom", [3.0, 8.0, 40.0, 1e6])
def test_chance_is_that_of_students_distribution(freedom: float) -> None:
    ours = two_sided_chance(NORMALISED, np.full(len(NORMALISED), freedom))
    np.testing.assert_allclose(ours, 2.0 * stats.t.sf(np.abs(NORMALISED), freedom), atol=2e-3)


def test_the_same_are_chosen_as_by_adjusted_chances() -> None:
    rng = np.random.default_rng(7)
    chance = np.concatenate([rng.uniform(size=400), rng.uniform(high=1e-3, size=60)])
    expected = stats.false_discovery_control(chance) <= 0.05
    assert np.array_equal(told_apart(chance), expected)
    assert not told_apart(np.empty(0)).any()
