"""``simulate-battery``: the files it writes agree with each other, and what it refuses."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from app.cli.main import main
from app.science.battery.config_reading import config_document, read_config
from app.science.battery.virtual.a123 import first_guess

LEAF = {
    "ocv": [[0.0, 3.0], [0.2, 3.6], [0.6, 3.8], [1.0, 4.2]],
    "initial": {
        "capacity_ah": 30.0,
        "resistance_ohm": 0.0015,
        "relaxation_capacitance_f": 2e4,
        "relaxation_resistance_ohm": 1e-3,
    },
    "series": 96,
    "parallel": 2,
}


def test_files_tell_the_report_s_cell(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate-battery", str(tmp_path), "--days", "0.5", "--bias-a", "0.02", "--fade", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path / "truth.json").read_text())
    truth = pq.read_table(tmp_path / "truth.parquet").to_pydict()
    with (tmp_path / "data.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["t_s", "current_a", "voltage_v"]
    errors = np.array([float(row["current_a"]) for row in rows]) - np.array(truth["current_a"])
    assert (errors.mean(), errors.std()) == (pytest.approx(0.02, abs=3e-4), pytest.approx(0.01, rel=0.02))
    assert (told["soc"], told["capacity_ah"]) == (truth["soc"][-1], truth["capacity_ah"][-1])
    assert told["resistance_ohm"] == 0.008
    assert 1.999 < told["capacity_ah"] < 2.0
    config = json.loads((tmp_path / "config.json").read_text())
    assert config["initial"] == config_document(first_guess())["initial"]
    assert config["start_after_s"] == 4320.0


def test_another_cell_and_drive_fill_the_same_files(tmp_path: Path) -> None:
    (tmp_path / "cell.json").write_text(json.dumps(LEAF))
    (tmp_path / "fade.json").write_text('{"current_a": [0], "soc": [0.5], "loss_ah_per_ah": [[1e-4]]}')
    (tmp_path / "drive.csv").write_text("t_s,speed_kmh\n0,0\n5,50\n10,60\n15,0\n")
    words = ["--days", "0.2", "--format", "parquet", "--temperature", "12", "8", "--cell", str(tmp_path / "cell.json")]
    words += ["--cycle", str(tmp_path / "drive.csv"), "--degradation", str(tmp_path / "fade.json")]
    assert main(["simulate-battery", str(tmp_path / "out"), *words]) == 0
    truth = json.loads((tmp_path / "out" / "truth.json").read_text())
    lost = truth["moved_ah_per_day"] * 0.2 * 1e-4
    assert truth["initial_capacity_ah"] - truth["capacity_ah"] == pytest.approx(lost, rel=1e-3)
    table = pq.read_table(tmp_path / "out" / "data.parquet")
    assert table.column("temperature_c").to_numpy().mean() > 12.0
    volts = table.column("voltage_v").to_numpy()
    assert 96 * 3.0 < volts.min() < volts.max() < 96 * 4.2
    config = read_config(json.loads((tmp_path / "out" / "config.json").read_text()))
    assert (config.cell.series, config.cell.parallel) == (96, 2)
    assert config.cell.circuit.capacity_ah == pytest.approx(33.0)
    assert config.cell.circuit.relaxation_resistance_ohm == pytest.approx(1e-3 / 1.1, rel=1e-5)


def test_the_same_seed_writes_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert main(["simulate-battery", str(tmp_path / name), "--days", "0.02", "--seed", "9"]) == 0
    assert (tmp_path / "a" / "data.csv").read_bytes() == (tmp_path / "b" / "data.csv").read_bytes()


@pytest.mark.parametrize(
    ("file", "option", "status", "words"),
    [
        ("{", "--degradation", 2, "is not JSON"),
        ('{"current_a": [0], "soc": [0.5], "loss_ah_per_ah": [[2]]}', "--degradation", 1, "loss_ah_per_ah.0[0]: 2 is"),
        ("t_s,speed_mps\n0,0\n9,5\n", "--cycle", 1, "Row 3: 9 s after the row before"),
        ('{"ocv": [3.0, 0.5]}', "--cell", 1, "initial"),
    ],
)
def test_files_that_cannot_be_used_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str, option: str, status: int, words: str
) -> None:
    (tmp_path / "given").write_text(file)
    assert (
        main(["simulate-battery", str(tmp_path / "out"), "--days", "0.02", option, str(tmp_path / "given")]) == status
    )
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
