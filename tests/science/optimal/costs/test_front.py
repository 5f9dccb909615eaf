"""Pareto fronts: their ends, their order, and that what is traded is what was asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.optimal.costs.front import Supported, pareto, undominated
from app.science.optimal.costs.frontier import FrontError
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from tests.science.optimal.documents import thesis

RPM, NM = np.linspace(1000.0, 6000.0, 11), np.linspace(10.0, 100.0, 10)
CONSTANT = {"rpm": [1000, 6000], "nm": [10, 100], "gps": [[0.02, 0.02], [0.02, 0.02]]}


def hot(gps_at_top: float = 1.0) -> dict[str, Any]:
    """Return an emission that grows with the square of power, as nitrogen oxides do where it is hot."""
    share = np.outer(RPM / 6000.0, NM / 100.0) ** 2
    return {"rpm": RPM.tolist(), "nm": NM.tolist(), "gps": (gps_at_top * share).tolist()}


def test_a_front_runs_from_the_least_fuel_to_the_least_emission() -> None:
    told: list[float] = []
    front = pareto(thesis(cost={"emissions": {"nox": hot()}}), "nox", 5, told.append).document()
    points = front["points"]
    assert (front["x_axis"], front["y_axis"], len(points)) == ("fuel_energy_j", "nox_g", 5)
    assert told[-1] == 1.0
    assert told == sorted(told)
    least = solve(read_problem(thesis())).document()["fuel_energy_j"]
    assert points[0]["x"] == pytest.approx(least, rel=1e-9)
    x, y = (np.array([point[name] for point in points]) for name in ("x", "y"))
    assert (np.diff(x) > 0.0).all()
    assert (np.diff(y) < 0.0).all()
    assert (np.diff(np.diff(y) / np.diff(x)) > 0.0).all()  # weights reach the convex part only
    for point in points:
        assert point["verdict"] == "optimal"
        assert point["emissions_g"]["nox"] == point["y"]
    middle = points[2]
    again = solve(read_problem(thesis(cost={"weights": middle["weights"], "emissions": {"nox": hot()}}))).document()
    assert again["fuel_energy_j"] == pytest.approx(middle["x"], rel=1e-6)


def test_a_constant_rate_trades_like_time() -> None:
    timed = pareto(thesis(), "time", 5)
    assert timed.y_axis == "time_s"
    mass = pareto(thesis(cost={"emissions": {"nox": CONSTANT}}), "nox", 5)
    for point in mass.points[1:-1]:
        same = solve(read_problem(thesis(time_s=point.y / 0.02))).document()["fuel_energy_j"]
        assert point.x == pytest.approx(same, rel=1e-5)
    x = [point.x for point in timed.points]
    assert x == sorted(x)
    assert timed.points[-1].time_s == pytest.approx(6.669 * 1.001, rel=1e-3)


def test_two_emissions_may_be_weighed_against_each_other() -> None:
    emissions = {"nox": hot(), "hc": CONSTANT}
    front = pareto(thesis(cost={"emissions": emissions}), "nox", 3, against="hc")
    assert (front.x_axis, front.y_axis) == ("hc_g", "nox_g")
    fastest = 6.669
    assert front.points[0].x == pytest.approx(
        0.02 * fastest, rel=1e-3
    )  # the least of a constant rate is the least time
    assert front.points[0].x < front.points[1].x < front.points[2].x
    assert front.points[0].y > front.points[1].y > front.points[2].y


def test_drives_that_others_beat_in_both_are_left_out() -> None:
    point = pareto(thesis(), "time", 2).points[0]
    drives = [Supported(point, x, y, 1.0, 0.0) for x, y in ((1.0, 3.0), (2.0, 3.5), (2.0, 2.0), (3.0, 1.0))]
    assert [(one.x, one.y) for one in undominated(drives)] == [(1.0, 3.0), (2.0, 2.0), (3.0, 1.0)]


@pytest.mark.parametrize(
    ("changes", "asked", "words"),
    [
        ({}, "nox", "There is no map of nox among cost.emissions; this problem knows fuel, co2 and time"),
        ({}, "co2", "grow with each other"),
    ],
)
def test_a_front_that_is_none_is_refused(changes: dict[str, Any], asked: str, words: str) -> None:
    with pytest.raises(FrontError, match=words):
        pareto(thesis(**changes), asked)


def test_cancelling_gets_through() -> None:
    def stop(_share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pareto(thesis(), "time", 3, stop)
