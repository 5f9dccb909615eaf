"""``fuel-model``: what it prints, and how it refuses half a road load."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli.main import app

CAMRY = ["--mass", "1644.3", "--abc", "117.918,1.97525,0.366729"]


def test_two_tests_predict_a_third_and_a_cycle_nobody_measured(shared_data: Callable[[str], Path]) -> None:
    tests, cycles = shared_data("dyno-camry-fuelflow"), shared_data("drive-cycles-fastsim")
    files = [str(tests / f"{name}.csv") for name in ("61811011", "61811012", "61811013")]
    asked = ["--predict", files[2], "--predict", str(cycles / "us06.csv")]
    done = CliRunner().invoke(app, ["fuel-model", *files[:2], *CAMRY, *asked, "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    highway, hard = answer["predictions"]
    assert abs(highway["difference"]) < 0.03
    assert hard["difference"] is None
    assert hard["litres_per_100km"] > highway["litres_per_100km"]
    assert hard["beyond_top"] > highway["beyond_top"]
    assert answer["model"]["tests"] == ["61811011", "61811012"]
    assert answer["model"]["slope_sd"] < 0.1 * answer["model"]["slope"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "Tell the road load"),
        (["--mass", "1500"], "--mass needs --cda and --crr"),
        (["--mass", "1500", "--abc", "1,2"], "Three numbers with commas"),
    ],
)
def test_half_a_road_load_is_refused(tmp_path: Path, words: list[str], told: str) -> None:
    table = tmp_path / "a.csv"
    table.write_text("t_s,speed_mps,fuel_g_s\n0,1,1\n1,1,1\n")
    done = CliRunner().invoke(app, ["fuel-model", str(table), *words])
    assert done.exit_code == 2
    assert told in done.stderr
