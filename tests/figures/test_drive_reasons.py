"""Figures that say why a drive is the best one: Hamiltonian, path over the map, competitors, synthesis, methods."""

from __future__ import annotations

import numpy as np
import pytest

from app.figures.drive import drive_figure
from app.figures.drive_documents import DrawnDrive
from app.figures.theme import Json
from app.science.optimal.reading import read_problem
from tests.figures.drives import acceleration, ball, hurried
from tests.science.optimal.documents import TABLE_4_1, thesis


def trace(figure: Json, name: str) -> Json:
    (found,) = [one for one in figure["data"] if one["name"] == name]
    return dict(found)


def values(figure: Json, name: str) -> np.ndarray:
    return np.array(trace(figure, name)["y"], dtype=float)


@pytest.mark.parametrize("drive", [acceleration, hurried])
def test_h_stays_at_mu_and_no_gear_is_above_it(drive: object) -> None:
    solved: DrawnDrive = drive()  # type: ignore[operator]  # one of the two functions
    figure = drive_figure("hamiltonian", solved)
    assert np.abs(values(figure, "H − μ, W")).max() < 1e-4, "of some 100 kW"
    best = np.array([values(figure, f"best in gear {gear}, kW") for gear in range(1, 7)])
    assert np.nanmax(best) <= 1e-3
    speed = np.array(solved.answer["trajectory"]["speed_mps"])
    gear = np.array(solved.answer["trajectory"]["gear"])
    inside = (speed > 12.0) & (speed < 14.0)
    assert set(gear[inside]) == {2}
    assert np.nanargmax(best[:, inside], axis=0) + 1 == pytest.approx(gear[inside])


def test_the_path_lies_over_the_efficiency_of_the_problems_formula() -> None:
    figure = drive_figure("path", acceleration())
    map_ = trace(figure, "Efficiency")
    i, j = map_["x"].index(3500), int(np.argmin(np.abs(np.array(map_["y"]) - 70.0)))
    omega, torque = 3500.0 * np.pi / 30.0, map_["y"][j]
    p = TABLE_4_1["phi"]
    phi = p[0] + p[1] * omega + p[2] * torque + p[3] * omega * torque + p[4] * omega**2 + p[5] * torque**2  # type: ignore[index]
    assert map_["z"][j][i] == pytest.approx(100.0 / phi, abs=0.06)
    path = trace(figure, "six gears")
    broken = [k for k, rpm in enumerate(path["x"]) if rpm is None]
    assert len(broken) == len(acceleration().answer["gears"]) - 1
    assert trace(figure, "gears of six gears")["text"] == ["1", "2", "3", "4", "5"]


def test_the_synthesis_is_drawn_with_the_way_through_it() -> None:
    figure = drive_figure("synthesis", ball())
    assert [one["name"] for one in figure["data"] if "to rest" in one["name"]] == [
        f"{one['time_s']:.3g} s to rest" for one in ball().answer["synthesis"]["isochrones"]
    ]
    assert trace(figure, "the way, u = −1")["x"][0] == 1.0
    assert trace(figure, "the way, u = 1.5")["x"][-1] == pytest.approx(0.0, abs=1e-4)


def test_competitors_are_told_by_what_more_they_burn() -> None:
    rivals = [{"name": "in one gear", "fuel_energy_j": 1.1e6}]
    answer = {"fuel_energy_j": 1.0e6, "candidates": rivals, "bound_j": 0.999e6, "trajectory": {}}
    figure = drive_figure("competitors", DrawnDrive(answer, read_problem(thesis())))
    (shown,) = figure["data"]
    assert dict(zip(shown["y"], shown["x"], strict=True)) == pytest.approx(
        {"the answer": 0.0, "in one gear": 10.0, "no drive below": -0.1}
    )


def test_methods_are_told_by_error_and_time() -> None:
    rows = [
        {"name": "by_hand", "relative_error": 1e-3, "milliseconds": 10.0},
        {"name": "exact", "relative_error": 0.0, "milliseconds": 0.5},
        {"name": "refused", "relative_error": None, "milliseconds": None},
    ]
    figure = drive_figure("methods", DrawnDrive({"trajectory": {}}, read_problem(thesis()), comparison={"rows": rows}))
    (shown,) = figure["data"]
    assert shown["text"] == ["by hand", "exact"]
    assert shown["y"] == [1e-3, 1e-12]


def test_a_front_is_dashed_where_no_weights_lead_to_a_drive() -> None:
    points = [
        {"x": 1e6, "y": 0.9, "time_s": 9.0, "verdict": "optimal"},
        {"x": 1.1e6, "y": 0.5, "time_s": 9.5, "verdict": "optimal"},
        {"x": 1.3e6, "y": 0.4, "time_s": 10.0, "verdict": "extremal"},
    ]
    front = {"x_axis": "fuel_energy_j", "y_axis": "nox_g", "points": points, "edges": [[1, 2]]}
    figure = drive_figure("front", DrawnDrive({"trajectory": {}}, read_problem(thesis()), front=front))
    assert [one["line"]["dash"] for one in figure["data"] if one["mode"] == "lines"] == ["solid", "dash"]
    assert trace(figure, "drives of the front")["x"] == [1000.0, 1100.0, 1300.0]
    assert figure["layout"]["yaxis"]["title"]["text"] == "NOₓ, g"


def test_a_road_is_drawn_with_the_limit_that_holds_at_each_place() -> None:
    road = {"distance_m": [0, 100, 300], "elevation_m": [5, 15, 5], "speed_limit_mps": [10, 20, 20]}
    route = {"road": road, "from_speed_mps": 8.0, "to_speed_mps": 8.0, "min_speed_mps": 3.0}
    problem = {**{name: part for name, part in thesis().items() if "speed" not in name and name != "time_s"}, **route}
    columns = {
        "distance_m": [0.0, 50.0, 100.0, 300.0],
        "speed_mps": [8.0, 9.0, 10.0, 8.0],
        "t_s": [0.0, 6.0, 11.0, 33.0],
    }
    drive = DrawnDrive({"trajectory": columns}, read_problem(problem | {"kind": "route"}))
    figure = drive_figure("road", drive)
    assert trace(figure, "Speed limit, km/h")["y"] == [36.0, 36.0, 72.0, 72.0]
    assert trace(figure, "Elevation, m")["x"] == [0.0, 0.1, 0.3]
    assert trace(figure, "Speed, km/h")["y"] == pytest.approx([28.8, 32.4, 36.0, 28.8])
