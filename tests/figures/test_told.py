"""The figure of what each minute tells."""

from __future__ import annotations

import numpy as np
import pytest

from app.figures.theme import DARK, LIGHT
from app.figures.told import mixed, told_figure


def test_each_window_has_its_place_and_a_pause_stays_blank() -> None:
    drawn = told_figure(
        np.array([30.0, 90.0, 270.0]), 60.0, {"speed_mps": np.array([1.0, 15.0, 0.15])}, {"speed_mps": 15.0}
    )
    (trace,) = drawn["data"]
    assert trace["x"] == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert trace["z"] == [[pytest.approx(6.6667), 100.0, None, None, 1.0]]
    assert trace["y"] == ["Speed"]
    assert trace["customdata"] == [["±3.6 km/h", "±54 km/h", "", "", "±0.54 km/h"]]


def test_without_windows_it_says_so() -> None:
    assert "minute" in str(told_figure(np.zeros(0), 60.0, {}, {})["layout"])


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_colours_lie_between_curve_and_ground(theme) -> None:
    assert (mixed(theme, 1.0), mixed(theme, 0.0)) == (theme.trace, theme.raised)
