"""Where a battery is heading: the figure tells the numbers of the ageing document."""

from __future__ import annotations

import json

import numpy as np
import plotly.graph_objects as go
import pytest

from app.figures.battery import battery_figure
from app.figures.battery_documents import DrawnBattery, HealthMark, LaboratoryMark
from app.figures.theme import LIGHT
from app.science.battery.ageing import HealthPoint, ageing

FIRST_DAY = 20_500.0
DAY_S = 86_400.0
RATED_AH = 33.1
LOSS_PER_DAY = 0.0005


def drawn(points: int) -> DrawnBattery:
    """A battery that loses half a thousandth of its rated capacity a day, known to a thousandth every ten days."""
    days = FIRST_DAY + 10.0 * np.arange(points)
    shares = 1.0 - LOSS_PER_DAY * (days - FIRST_DAY)
    sd = 0.001
    history = [
        HealthPoint(day, RATED_AH * share, RATED_AH * sd, 0.003, 3e-5, 40.0, carried=False)
        for day, share in zip(days, shares, strict=True)
    ]
    document = json.loads(json.dumps(ageing(history, 0.8, (), rated_ah=RATED_AH).document()))
    marks = [HealthMark(day * DAY_S, "trip", share, sd) for day, share in zip(days, shares, strict=True)]
    tests = (LaboratoryMark((FIRST_DAY + 50.0) * DAY_S, 0.97, 0.005),)
    return DrawnBattery(marks=marks, tests=tests, ageing=document, threshold=0.8)


def test_the_trend_goes_through_the_points_and_on_beyond_them() -> None:
    figure = battery_figure("ageing", drawn(20))
    go.Figure(json.loads(json.dumps(figure, allow_nan=False)))
    by_name = {one["name"]: one for one in figure["data"]}
    seen, ahead = by_name["Capacity, trend, %"], by_name["Capacity, trend, carried on, %"]
    assert seen["x"][0] == "2026-02-16 00:00:00"
    assert seen["y"][0] == pytest.approx(100.0, abs=0.05)
    assert (seen["x"][-1], seen["y"][-1]) == (ahead["x"][0], ahead["y"][0])
    assert seen["x"][-1] <= by_name["Capacity, %"]["x"][-1] < ahead["x"][1]
    assert by_name["Capacity, %"]["y"] == pytest.approx([100.0 - 0.5 * k for k in range(20)], abs=0.01)
    assert by_name["Series resistance, %"]["yaxis"] == "y2"
    assert by_name["Tested in a laboratory, %"]["y"] == [97.0]


def test_the_time_to_the_end_of_life_lies_upon_its_line() -> None:
    battery = drawn(20)
    assert battery.ageing is not None
    left = battery.ageing["capacity"]["remaining"]
    line, *bars = battery_figure("ageing", battery)["layout"]["shapes"]
    assert (line["y0"], line["xref"]) == (80.0, "paper")
    known = left["remaining_low_days"] is not None and left["remaining_high_days"] is not None
    assert [(bar["y0"], bar["y1"]) for bar in bars] == [(80.0, 80.0)] * known
    assert left["remaining_days"] == pytest.approx(0.2 / LOSS_PER_DAY - 190.0, abs=2.0)


def test_without_a_trend_the_history_is_drawn() -> None:
    few = drawn(2)
    assert battery_figure("ageing", few) == battery_figure("soh", few)
    assert battery_figure("ageing", few, theme=LIGHT)["layout"]["annotations"][0]["text"] == "end of life, 80 %"
