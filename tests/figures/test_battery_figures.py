"""Figures of batteries: valid for Plotly, and of the numbers that the answer tells."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from app.figures.battery import NAMES, battery_figure
from app.figures.battery_curve import open_circuit, proposed_figure
from app.figures.battery_documents import DrawnBattery, HealthMark, LaboratoryMark
from app.figures.theme import DARK, LIGHT, Json, Theme

DAY_S = 86400.0
MAY_2026 = 1777593600.0
ROWS = 200


def answer() -> dict[str, Any]:
    """An answer of an hour whose residuals are normal with 2 mV."""
    share = np.linspace(0.0, 1.0, ROWS)
    steady = {"resistance_ohm": 0.008, "relaxation_capacitance_f": 2700.0, "relaxation_resistance_ohm": 0.011}
    columns = {name: np.full(ROWS, value) for name, value in steady.items()}
    columns |= {f"{name}_sd": 0.1 * (1.05 - share) * value for name, value in steady.items()}
    residual = np.random.default_rng(5).normal(0.0, 0.002, ROWS)
    columns |= {"t_s": 3600.0 * share, "soc": 0.7 - 0.4 * share, "soc_sd": 0.05 * (1.05 - share)}
    columns |= {"capacity_ah": 2.2 - 0.2 * share, "capacity_ah_sd": 0.2 * (1.05 - share), "residual_v": residual}
    history: dict[str, list[float | None]] = {name: column.tolist() for name, column in columns.items()}
    history["residual_v"][0] = None
    return {"soc": 0.3, "voltage_noise_v": 0.002, "history": history}


CONFIG = {"ocv": [[0.0, 2.8], [0.5, 3.3], [1.0, 3.5]], "initial": {"capacity_ah": 2.2, "resistance_ohm": 0.01}}
MARKS = tuple(HealthMark(MAY_2026 + 30 * k * DAY_S, f"trip {k}", 1.0 - 0.01 * k, 0.01, f"e{k}") for k in range(6))
TESTS = (LaboratoryMark(MAY_2026 + 90 * DAY_S, 0.965, 0.005, "<b>bench & room</b>"),)
WHOLE = DrawnBattery(answer(), CONFIG, MARKS, TESTS)


def trace(figure: Json, name: str) -> Json:
    (found,) = [one for one in figure["data"] if one["name"] == name]
    return dict(found)


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)
@pytest.mark.parametrize("drawn", [WHOLE, DrawnBattery()], ids=["whole", "empty"])
@pytest.mark.parametrize("name", NAMES)
def test_plotly_accepts_them(name: str, drawn: DrawnBattery, theme: Theme) -> None:
    figure = battery_figure(name, drawn, theme=theme)  # type: ignore[arg-type]  # each of NAMES is one
    go.Figure(json.loads(json.dumps(figure, allow_nan=False)))
    assert figure["layout"]["uirevision"]
    assert bool(figure["data"]) == (drawn is WHOLE and name != "current")


def test_the_state_of_charge_is_drawn_in_per_cent_with_its_bands() -> None:
    figure = battery_figure("soc", WHOLE)
    line = trace(figure, "State of charge, %")
    assert (line["y"][0], line["y"][-1]) == (70.0, 30.0)
    assert line["x"][-1] == 60.0
    assert figure["layout"]["xaxis"]["title"]["text"] == "Time, min"
    band = trace(figure, "State of charge, ±2σ")
    assert max(band["y"]) == pytest.approx(70.0 + 2 * 5.25, abs=0.01)


def test_what_the_car_tells_lies_over_it_on_the_same_clock() -> None:
    told = (np.array([600.0, 3000.0]), np.array([0.66, 0.4]))
    line = trace(battery_figure("soc", replace(WHOLE, told=told)), "Told by the car, %")
    assert (line["x"], line["y"]) == ([10.0, 50.0], [66.0, 40.0])
    assert line["line"]["dash"] == "dash"


def test_parameters_stand_beside_what_they_were_thought_to_be() -> None:
    figure = battery_figure("parameters", WHOLE)
    assert figure["layout"]["meta"]["panels"] == [
        "Capacity", "Series resistance", "Relaxation capacitance", "Relaxation resistance",
    ]  # fmt: skip
    assert set(trace(figure, "Series resistance, mΩ")["y"]) == {8.0}
    begun = {one["yaxis"]: one["y"] for one in figure["data"] if one["name"].startswith("To begin with")}
    assert begun == {"y": [2.2, 2.2], "y2": [10.0, 10.0]}


def test_the_histogram_counts_every_row_and_noise_alone_would_be_as_many() -> None:
    figure = battery_figure("residual", WHOLE)
    assert sum(trace(figure, "How often")["x"]) == ROWS - 1
    assert sum(trace(figure, "Noise alone")["x"]) == pytest.approx(ROWS - 1, rel=0.01)
    levels = [shape["y0"] for shape in figure["layout"]["shapes"]]
    assert levels == [-4.0, 4.0]


def test_the_curve_shows_where_the_pack_has_been() -> None:
    figure = battery_figure("curve", WHOLE)
    assert trace(figure, "Open-circuit voltage")["y"][100] == 3.3
    visited = trace(figure, "Where the pack has been, % of the time")
    been = [x for x, share in zip(visited["x"], visited["y"], strict=True) if share > 0]
    assert (min(been), max(been)) == (31.0, 71.0)
    assert sum(visited["y"]) == pytest.approx(100.0, abs=0.1)


def test_a_proposed_curve_goes_between_the_directions_and_beside_the_present_one() -> None:
    proposed = {"ocv": [[0.0, 2.9], [1.0, 3.6]], "soc": [0.1, 0.9], "volts": [2.95, 3.55], "spread_v": [0.01, None]}
    figure = proposed_figure(proposed, open_circuit([2.8, 0.7]), LIGHT)
    assert [one["name"] for one in figure["data"]] == [
        "Charging", "Discharging", "Present curve", "New curve", "Rows of the table",
    ]  # fmt: skip
    assert trace(figure, "Present curve")["y"][-1] == 3.5
    assert trace(figure, "Charging")["y"] == [2.955, None]
    assert trace(figure, "Discharging")["y"] == [2.945, None]


def test_health_goes_over_dates_with_tests_and_the_end_of_life() -> None:
    figure = battery_figure("soh", WHOLE)
    marks = trace(figure, "State of health, %")
    assert marks["x"][0] == "2026-05-01 00:00:00"
    assert marks["y"] == [100.0, 99.0, 98.0, 97.0, 96.0, 95.0]
    assert trace(figure, "Tested in a laboratory, %")["customdata"] == ["&lt;b&gt;bench &amp; room&lt;/b&gt;"]
    assert figure["layout"]["shapes"][0]["y0"] == 80.0
    low, high = figure["layout"]["yaxis"]["range"]
    assert low < 80.0 < 100.0 < high
