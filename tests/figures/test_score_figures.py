"""Figures of a score: lines with a gap at each stop, bars that add up, cells and places in the right colours."""

from __future__ import annotations

import numpy as np
import pytest

from app.figures.score_along import along_figure
from app.figures.score_cells import cells_figure
from app.figures.score_parts import parts_figure
from app.figures.score_place import place_plan_figure
from app.figures.theme import DARK
from app.science.eco.result import Along
from tests.eco.conftest import ROWS, along, judged


def test_lines_of_driven_and_best_have_a_gap_at_the_stop() -> None:
    drawn = along_figure(along())
    names = [trace["name"] for trace in drawn["data"]]
    assert names[:3] == ["Limit, km/h", "As driven, km/h", "Best drive, km/h"]
    driven, best = drawn["data"][1], drawn["data"][2]
    assert len(driven["y"]) == ROWS + 1
    assert driven["y"].count(None) == 1
    assert driven["y"][0] == pytest.approx(36.0)
    assert best["y"][-1] == pytest.approx(32.4)
    assert driven["line"] != best["line"]
    assert driven["x"] == sorted(driven["x"])


def test_without_rows_the_figure_says_why() -> None:
    assert "could be scored" in along_figure(Along.nothing())["layout"]["annotations"][0]["text"]


def test_parts_stand_on_each_other_and_add_up() -> None:
    score = judged(86.0)
    (bars,) = parts_figure(score, theme=DARK)["data"]
    assert bars["base"][1:-1] == pytest.approx(np.cumsum(bars["x"][:-2]), abs=1e-3)
    assert bars["x"][-1] == pytest.approx(score.saved_l.value, abs=1e-3)
    assert bars["y"] == ["Braked away", "Engine off its best working points", "Not explained", "Together"]


def test_cells_lie_where_they_are_in_the_map_and_zero_has_the_middle_colour() -> None:
    (cells,) = cells_figure(judged(86.0))["data"]
    assert (cells["x"], cells["y"]) == ([2000.0, 2050.0], [40.0, 42.0])
    assert cells["z"] == [[2.0, None], [None, -1.0]]
    assert cells["zmin"] == -cells["zmax"]


def test_the_way_is_drawn_only_where_it_is_known() -> None:
    north = np.linspace(0.0, 100.0, ROWS)
    places = {"north_m": np.where(north < 50.0, north, np.nan), "east_m": np.zeros(ROWS)}
    (way,) = place_plan_figure(along(), places)["data"]
    assert len(way["y"]) == np.count_nonzero(north < 50.0)
    assert way["marker"]["cmin"] == -way["marker"]["cmax"]
