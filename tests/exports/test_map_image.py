"""The map as a picture."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from lxml import etree
from PIL import Image

from app.exports.map_image import map_image
from app.science.engine.cells import EMPTY, accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.errors import TooLittleData
from app.science.vehicle.model import Vehicle
from tests.synthetic import points_at, random_points

GRID = CellGrid()
MAP = build_map(accumulate(random_points(50_000), GRID), GRID, Vehicle())


def test_the_png_is_a_picture_full_of_colour() -> None:
    data = map_image(MAP, title="Smart Roadster, $5 & <more>")
    assert data == map_image(MAP, title="Smart Roadster, $5 & <more>")
    picture = np.asarray(Image.open(io.BytesIO(data)).convert("HSV"))
    assert picture.shape == (780, 1200, 3)
    assert (picture[..., 1] > 60).mean() > 0.2


def test_the_svg_says_what_is_drawn() -> None:
    data = map_image(MAP, title="Smart Roadster", form="svg")
    assert data == map_image(MAP, title="Smart Roadster", form="svg")
    root = etree.fromstring(data)
    comments = " ".join(str(c.text) for c in root.iter(etree.Comment))
    for words in (
        "Smart Roadster",
        "Engine speed, rpm",
        "Torque, Nm",
        "Efficiency, %",
        "highest torque seen",
        "best: 38.9 % (216 g/kWh)",
    ):
        assert words in comments


def test_a_map_of_a_single_cell_can_be_drawn() -> None:
    one = points_at(np.full(20, 2025.0), np.full(20, 41.0))
    assert map_image(build_map(accumulate(one, GRID), GRID, Vehicle()), title="one", form="png")[1:4] == b"PNG"


def test_an_empty_map_says_so() -> None:
    with pytest.raises(TooLittleData, match="nothing to draw"):
        map_image(build_map(EMPTY, GRID, Vehicle()), title="none")
    untrusted = replace(MAP, efficiency=np.full(len(MAP.n), np.nan))
    with pytest.raises(TooLittleData):
        map_image(untrusted, title="none")
