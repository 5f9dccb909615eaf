"""Full load and idle as they are drawn: solid with a band where reached, dotted elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import plotly.graph_objects as go

from app.exports.map_image import map_image
from app.figures.map_contour import contour_figure
from app.figures.map_limits import full_load_lines, idle_line
from app.figures.theme import LIGHT
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid, Idle
from app.science.engine.full_load import FullLoad
from app.science.vehicle.model import Vehicle
from tests.synthetic import random_points

RPM = np.array([1500.0, 1600.0, 1700.0, 1800.0, 1900.0])
REACHED = np.array([False, True, True, False, False])
LINE = FullLoad(RPM, np.array([60.0, 70.0, 80.0, 85.0, 86.0]), np.array([3.0, 1.0, 2.0, 3.0, 3.0]), REACHED)
IDLE = Idle(820.0, 8.0, 3500.0, 150.0, 0.39, 61.0)
POINTS = random_points(60_000)
MAP = build_map(accumulate(POINTS, CellGrid()), CellGrid(), Vehicle(), LINE, IDLE)


def test_what_was_reached_is_solid_and_what_was_not_dotted() -> None:
    band, solid, dotted = full_load_lines(MAP, LIGHT)
    assert solid["y"] == [None, 70.0, 80.0, None, None]
    assert solid["customdata"] == [None, 2.0, 4.0, None, None]
    assert dotted["y"] == [60.0, 70.0, 80.0, 85.0, 86.0]
    assert dotted["line"]["dash"] == "dot"
    assert "dash" not in solid["line"]
    assert band["x"] == [1600.0, 1700.0, 1700.0, 1600.0, None]
    assert band["y"] == [72.0, 84.0, 76.0, 68.0, None]


def test_nothing_reached_is_dotted_all_along() -> None:
    for reached in (None, np.zeros(5, np.bool_)):
        (dotted,) = full_load_lines(replace(MAP, full_load_reached=reached), LIGHT)
        assert dotted["y"] == [60.0, 70.0, 80.0, 85.0, 86.0]


def test_idle_stands_in_the_figure_with_its_consumption() -> None:
    (line,) = idle_line(MAP.idle, 100.0, LIGHT)
    assert line["x"] == [820.0, 820.0]
    assert line["name"] == "idle: 820 rpm, 0.39 L/h"
    assert idle_line(None, 100.0, LIGHT) == []
    figure = contour_figure(MAP)
    go.Figure(figure)
    assert figure["layout"]["xaxis"]["range"][0] < 820.0
    assert {"idle: 820 rpm, 0.39 L/h", "full load", "highest seen, maybe not full load"} <= {
        trace.get("name") for trace in figure["data"]
    }


def test_the_saved_image_shows_both_kinds() -> None:
    image = map_image(MAP, title="one", form="svg").decode()
    assert image.count("full load") == 1
    assert "highest torque seen" in image
