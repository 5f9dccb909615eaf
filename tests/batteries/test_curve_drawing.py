"""A curve is drawn without being kept, and refused by its row."""

from __future__ import annotations

from tests.batteries.conftest import Bench

RISING = [[0.0, 3.0], [0.5, 3.6], [1.0, 4.1]]


def test_a_curve_is_drawn_beside_the_present_one(bench: Bench) -> None:
    body = {"ocv": RISING, "present": {"ocv": [3.1, 0.9]}}
    figure = bench.ask("POST", "/curves/figure", json=body, params={"theme": "dark"})
    ends = {one["name"]: (one["y"][0], one["y"][-1]) for one in figure["data"]}
    assert ends == {"Present curve": (3.1, 4.0), "New curve": (3.0, 4.1), "Rows of the table": (3.0, 4.1)}


def test_the_directions_of_a_fit_lie_around_it(bench: Bench) -> None:
    rows = {"soc": [0.0, 1.0], "volts": [3.0, 4.1], "spread_v": [0.02, None]}
    figure = bench.ask("POST", "/curves/figure", json={"ocv": RISING, **rows})
    assert [one["y"] for one in figure["data"][:2]] == [[3.01, None], [2.99, None]]


def test_what_is_no_curve_is_refused_by_its_row(bench: Bench) -> None:
    falling = bench.ask("POST", "/curves/figure", 422, json={"ocv": [*RISING[:2], [1.0, 3.2]]})
    assert falling["path"] == "ocv[2]"
    assert "3.2 V are below the 3.6 V" in falling["detail"]
    typed = bench.ask("POST", "/curves/figure", 422, json={"ocv": [[0.0, "x"], [1.0, 4.0]]})
    assert typed["path"].startswith("ocv[0]")


def test_rows_of_a_fit_go_together(bench: Bench) -> None:
    short = bench.ask("POST", "/curves/figure", 422, json={"ocv": RISING, "soc": [0.0], "volts": [3.0, 4.1]})
    assert "one number a row each" in short["detail"]
