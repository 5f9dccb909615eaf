"""The report's figures tell the numbers of its runs."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from app.figures.battery_report import REPORT_FIGURES, report_figure
from app.figures.theme import DARK, LIGHT, Theme
from app.science.battery.report import ReportRun, ReportRuns, Traces
from app.science.battery.virtual.ageing import DEFAULT_MAP

TRUTH = {"capacity_ah": 2.0, "resistance_ohm": 0.008, "relaxation_capacitance_f": 2700.0,
         "relaxation_resistance_ohm": 0.011, "soc": 0.5}  # fmt: skip
T_S = np.linspace(0.0, 864_000.0, 11)


def run(estimator: Any, terms: int | None, ends: float) -> ReportRun:
    """Ten days that begin a fifth too high and end as a share of the truth."""
    off = np.linspace(1.2, ends, len(T_S))
    columns = {name: value * off for name, value in TRUTH.items()}
    columns |= {f"{name}_true": np.full(len(T_S), value) for name, value in TRUTH.items()}
    return ReportRun(estimator, terms, 86_400.0, Traces(T_S, columns | {"voltage_rms_v": 0.01 * off - 0.008}))


def runs() -> dict[str, Any]:
    """The document of runs that are made up."""
    time = np.arange(5.0)
    two = {"current_a": -time, "voltage_v": 3.3 + 0.01 * time}
    short = (run("gpc", 2, 1.05), run("gpc", 3, 1.001), run("ekf_bias", None, 1.0))
    made = ReportRuns(
        curve=Traces(time, {"soc": 0.2 * time, "voltage_v": 3.0 + 0.1 * time}),
        pulses=Traces(time, two),
        drive=Traces(time, {"speed_mps": 10.0 * time, "current_a": -time}),
        cycling=Traces(3600.0 * time, {"current_a": -time, "soc": 0.8 - 0.1 * time}),
        short=short,
        degradation=DEFAULT_MAP,
        long=short[1:],
    )
    return dict(json.loads(json.dumps(made.document(), allow_nan=False)))


def lines(number: Any) -> dict[str, list[float]]:
    return {one["name"]: one["y"] for one in report_figure(number, runs())["data"]}


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)
@pytest.mark.parametrize("number", REPORT_FIGURES)
def test_plotly_accepts_them(number: Any, theme: Theme) -> None:
    drawn = report_figure(number, runs(), theme=theme)
    go.Figure(json.loads(json.dumps(drawn, allow_nan=False)))
    assert drawn["data"]


def test_the_drive_and_the_cycling_are_told_in_units_people_read() -> None:
    assert lines("27")["Speed, km/h"] == [0.0, 36.0, 72.0, 108.0, 144.0]
    assert lines("28")["State of charge, %"] == [80.0, 70.0, 60.0, 50.0, 40.0]
    assert report_figure("28", runs())["data"][0]["x"][-1] == 4.0


def test_parameters_of_every_run_stand_beside_the_truth() -> None:
    found = lines("30")
    assert set(found["Capacity, truth, Ah"]) == {2.0}
    assert found["Capacity, gpc, N = 2, Ah"][-1] == pytest.approx(2.1)
    assert found["Relaxation resistance, gpc, N = 3, mΩ"][-1] == pytest.approx(11.011)
    dashes = {one["name"]: one["line"].get("dash") for one in report_figure("30", runs())["data"]}
    assert (dashes["Capacity, gpc, N = 2, Ah"], dashes["Capacity, truth, Ah"]) == ("dash", "dot")


def test_errors_are_of_three_terms_and_the_default_beside_the_noise() -> None:
    found = lines("31")
    assert found["Error of the charge, gpc, N = 3, points"][0] == pytest.approx(10.0)
    assert found["Voltage error, ekf_bias, mV"][-1] == pytest.approx(2.0)
    assert found["Noise of the voltage, mV"] == [2.0, 2.0]
    assert not any("N = 2" in name for name in found)


def test_the_degradation_map_is_drawn_as_it_is() -> None:
    (surface,) = report_figure("32", runs())["data"]
    assert surface["z"][0][0] == 90.0
    assert surface["y"] == list(DEFAULT_MAP.current_a)
