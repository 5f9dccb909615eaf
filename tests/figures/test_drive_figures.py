"""Figures of drives: valid for Plotly, and of the numbers that the answer tells."""

from __future__ import annotations

import json

import numpy as np
import plotly.graph_objects as go
import pytest

from app.figures.drive import NAMES, drive_figure
from app.figures.drive_documents import drawn_drive
from app.figures.theme import DARK, LIGHT, Json, Theme
from tests.figures.drives import acceleration, ball, hurried
from tests.science.optimal.documents import thesis


def trace(figure: Json, name: str) -> Json:
    (found,) = [one for one in figure["data"] if one["name"] == name]
    return dict(found)


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)
@pytest.mark.parametrize("name", NAMES)
def test_plotly_accepts_them(name: str, theme: Theme) -> None:
    for drive in (acceleration(), ball()):
        figure = drive_figure(name, drive, theme=theme)  # type: ignore[arg-type]  # each of NAMES is one
        go.Figure(json.loads(json.dumps(figure, allow_nan=False)))
        assert figure["layout"]["uirevision"]


def test_the_stack_shows_the_trajectory_in_the_units_people_read() -> None:
    figure, trajectory = drive_figure("stack", acceleration()), acceleration().answer["trajectory"]
    assert figure["layout"]["meta"]["panels"] == [
        "Speed", "Gear", "Engine speed", "Torque", "Fuel power", "Costate of speed",
    ]  # fmt: skip
    speed = trace(figure, "Speed, km/h")
    assert speed["x"] == pytest.approx(trajectory["t_s"], abs=1e-4)
    assert speed["y"] == pytest.approx(3.6 * np.array(trajectory["speed_mps"]), abs=0.006)
    assert set(trace(figure, "Full load, Nm")["y"]) == {100.0}
    assert drive_figure("stack", acceleration(), over="distance")["layout"]["xaxis"]["title"]["text"] == "Distance, km"


def test_two_drives_lie_over_each_other_under_their_names() -> None:
    figure = drive_figure("speed", acceleration(), other=hurried())
    assert [one["name"] for one in figure["data"]] == ["six gears, km/h", "eight seconds, km/h"]
    assert figure["data"][1]["x"][-1] == pytest.approx(8.0, abs=1e-4)
    low, high = figure["layout"]["xaxis"]["range"]
    assert (low, high) == (0.0, pytest.approx(acceleration().answer["time_s"], abs=1e-4))


def test_a_name_is_text_and_never_markup() -> None:
    drive = drawn_drive(acceleration().answer, thesis(), name="<b>up & away</b>")
    assert trace(drive_figure("path", drive), "&lt;b&gt;up &amp; away&lt;/b&gt;")
