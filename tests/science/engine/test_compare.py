"""Two maps of the same and of another engine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.engine.compare import POINTS_PER_LOOK, compare_maps
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.errors import ScienceError


def measured(seed: int, factor: float = 1.0, bump: float = 0.0) -> EfficiencyMap:
    """A map whose cells' means scatter as their points do; ``bump`` lifts the cells at 3025 rpm."""
    rng = np.random.default_rng(seed)
    rpm, nm = (a.ravel() for a in np.meshgrid(np.arange(1525.0, 4500.0, 50.0), np.arange(21.0, 90.0, 2.0)))
    n, sd = rng.integers(20, 400, len(rpm)), np.full(len(rpm), 0.02)
    truth = factor * (0.25 + 0.1 * np.sin(rpm / 1500.0) * nm / 90.0) + bump * (rpm == 3025.0)
    efficiency = truth + sd / np.sqrt(n / POINTS_PER_LOOK) * rng.standard_normal(len(rpm))
    return EfficiencyMap(CellGrid(), rpm, nm, n, efficiency, sd, 84.0 / efficiency, np.empty(0), np.empty(0))


def test_the_same_engine_is_the_same() -> None:
    shares, levels = [], []
    for seed in range(0, 40, 2):
        found = compare_maps(measured(seed), measured(seed + 1))
        shares.append(found.significant.mean())
        levels.append((found.level - 1.0) / found.level_sd)
    assert np.mean(shares) < 0.01
    assert 0.6 < np.std(levels) < 1.6


def test_a_worse_engine_is_found_with_how_much() -> None:
    found = compare_maps(measured(1), measured(2, factor=0.96))
    assert found.level == pytest.approx(0.96, abs=3.0 * found.level_sd)
    assert found.level_sd < 0.004


def test_a_change_at_one_speed_is_found_there() -> None:
    found = compare_maps(measured(1), measured(2, bump=0.05))
    changed = found.significant & (found.rpm == 3025.0)
    assert changed.sum() > 0.7 * (found.rpm == 3025.0).sum()
    assert (found.significant & (found.rpm != 3025.0)).mean() < 0.01


def test_what_cannot_be_compared_is_said() -> None:
    one = measured(1)
    with pytest.raises(ScienceError, match="cells differ"):
        compare_maps(one, replace(one, grid=CellGrid(rpm=100.0)))
    nothing = replace(one, efficiency=np.full(len(one.rpm), np.nan))
    with pytest.raises(ScienceError, match="share 0 trusted cells"):
        compare_maps(one, nothing)
