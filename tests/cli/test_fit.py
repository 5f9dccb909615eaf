"""``./ponthy fit`` and ``compare`` on a map whose truth is Table 4.1."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli.main import app

PHI = [9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04]


@pytest.fixture
def map_file(tmp_path: Path) -> Path:
    cells = []
    for rpm in np.arange(1525.0, 5000.0, 50.0):
        for nm in np.arange(21.0, 101.0, 2.0):
            w = rpm * np.pi / 30.0
            phi = float(np.dot(PHI, [1.0, w, nm, w * nm, w * w, nm * nm]))
            cells.append({"rpm": rpm, "nm": nm, "n": 400, "efficiency": 1.0 / phi, "sd": 0.01, "bsfc_gpkwh": None})
    path = tmp_path / "map.json"
    path.write_text(json.dumps({"cell": {"rpm": 50, "nm": 2}, "cells": cells, "full_load": []}))
    return path


def test_the_tables_coefficients_come_back(map_file: Path) -> None:
    done = CliRunner().invoke(app, ["fit", str(map_file), "--target", "phi", "--degree", "2", "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert answer["best"] == "table 4.1"
    (table,) = [one for one in answer["fits"] if one["name"] == "table 4.1"]
    assert table["words"] == ["1", "ω", "T", "ωT", "ω²", "T²"]
    assert table["coefficients"] == pytest.approx(PHI, rel=1e-9)
    assert table["r_squared"] == pytest.approx(1.0)
    assert (table["peak"]["rpm"], table["peak"]["nm"]) == (pytest.approx(3867, abs=50), pytest.approx(92.9, abs=2))


def test_a_person_reads_a_table_and_own_terms_work(map_file: Path) -> None:
    done = CliRunner().invoke(app, ["fit", str(map_file), "--target", "p_in", "--terms", "1,w,wT,w2T,wT2"])
    assert done.exit_code == 0, done.output
    assert "ω²T" in done.stdout
    assert "proposed" in done.stdout


def test_fuel_power_goes_through_idle_and_has_a_willans_model(map_file: Path) -> None:
    idle = {"rpm": 850, "rpm_sd": 9, "fuel_power_w": 6500, "fuel_power_sd_w": 50, "litres_per_hour": 1, "seconds": 60}
    document = json.loads(map_file.read_text()) | {"idle": idle}
    map_file.write_text(json.dumps(document))
    done = CliRunner().invoke(app, ["fit", str(map_file), "--target", "p_in", "--degree", "2", "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert answer["idle"] == idle
    (willans,) = [one for one in answer["fits"] if one["name"] == "Willans"]
    assert willans["units"] == ["W", "W·s/rad", "W·s²/rad²", "W·s/(rad·Nm)", "W·s/(rad·Nm²)"]
    assert min(willans["coefficients"]) >= 0.0
    assert willans["idle_fuel_power_w"] == pytest.approx(6500, rel=0.2)
    assert willans["non_convexity"] > 3.0


def test_the_remedies_are_called_by_name(map_file: Path) -> None:
    call = ["fit", str(map_file), "--degree", "4", "--json"]
    done = CliRunner().invoke(app, [*call, "--remedy", "border"])
    assert json.loads(done.stdout)["remedy"] == "border"
    refused = CliRunner().invoke(app, [*call, "--target", "phi", "--remedy", "border"])
    assert "choose the remedy 'cut'" in str(refused.exception)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "not JSON"),
        ("{}", "needs cell.rpm"),
        ('{"cell": {"rpm": 50, "nm": 2}, "cells": []}', "0 trusted cells"),
    ],
)
def test_what_is_no_map_is_said(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "map.json"
    path.write_text(text)
    done = CliRunner().invoke(app, ["fit", str(path)])
    assert done.exit_code != 0
    assert words in f"{done.output} {done.exception}"


def test_two_maps_and_a_table_are_compared(map_file: Path, tmp_path: Path) -> None:
    document = json.loads(map_file.read_text())
    rows = [f"{cell['rpm']},{cell['nm']},{cell['efficiency'] / 0.97}" for cell in document["cells"][::3]]
    table = tmp_path / "dyno.csv"
    table.write_text("\n".join(["rpm,nm,efficiency", *rows]))
    done = CliRunner().invoke(app, ["compare", str(map_file), str(table), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["scale"] == pytest.approx(0.97, rel=1e-3)
    for cell in document["cells"]:
        cell["efficiency"] *= 0.9
    worse = tmp_path / "worse.json"
    worse.write_text(json.dumps(document))
    done = CliRunner().invoke(app, ["compare", str(map_file), str(worse), "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert answer["level"] == pytest.approx(0.9)
    assert answer["changed_cells"] > 0.9 * answer["common_cells"]
    assert "second over first" in CliRunner().invoke(app, ["compare", str(map_file), str(worse)]).stdout
