"""``./ponthy battery``: answers as JSON and in words, what it writes, and its exit status."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from app.cli.main import main
from tests.science.battery.plain_cell import CONFIG, TRUTH, driven


def files(folder: Path, config: Any = CONFIG, rows: int = 6000) -> tuple[str, str]:
    record = driven(rows)
    table = np.column_stack([record.t_s, record.current_a, record.voltage_v])
    data, document = folder / "data.csv", folder / "config.json"
    np.savetxt(data, table, delimiter=",", header="t_s,current_a,voltage_v", comments="", fmt="%.6f")
    document.write_text(config if isinstance(config, str) else json.dumps(config))
    return str(data), str(document)


def test_the_answer_has_the_names_others_rely_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, config = files(tmp_path)
    assert main(["battery", data, "--config", config, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    for name in ("capacity_ah", "resistance_ohm", "relaxation_capacitance_f", "relaxation_resistance_ohm", "soc"):
        assert answer[f"{name}_sd"] > 0.0
    assert answer["resistance_ohm"] == pytest.approx(TRUTH["resistance_ohm"], rel=0.01)
    assert {"soh", "voltage_rms_v", "history", "warnings"} <= set(answer)


def test_people_get_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, config = files(tmp_path, CONFIG | {"series": 1})
    assert main(["battery", data, "--config", config, "--estimator", "ekf"]) == 0
    told = capsys.readouterr()
    assert "state of health" in told.out
    assert "learnt from by ekf" in told.out
    assert "100 % of the rows" in told.err


def test_what_is_written_begins_the_next_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, config = files(tmp_path)
    out = tmp_path / "out"
    assert main(["battery", data, "--config", config, "--out", str(out), "--json"]) == 0
    alone = json.loads(capsys.readouterr().out)
    assert json.loads((out / "answer.json").read_text()) == alone
    assert pq.read_table(out / "history.parquet").num_rows == len(alone["history"]["t_s"])
    assert main(["battery", data, "--config", config, "--carry", str(out / "carry.json"), "--json"]) == 0
    carried = json.loads(capsys.readouterr().out)
    assert carried["resistance_ohm_sd"] < alone["resistance_ohm_sd"]


@pytest.mark.parametrize(
    ("config", "options", "status", "words"),
    [
        ("{", [], 2, "is not JSON"),
        (CONFIG, ["--estimator", "kalman"], 2, "none of ekf_bias"),
        (CONFIG | {"ocv": [3.3]}, [], 1, "ocv: "),
        (CONFIG | {"initial": {}}, [], 1, "initial.capacity_ah: is missing"),
        ([], [], 1, "not an object"),
        ("[]", ["--estimator", "ekf"], 1, "not an object"),
    ],
)
def test_a_failure_is_one_line(
    config: Any, options: list[str], status: int, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, document = files(tmp_path, config, rows=50)
    assert main(["battery", data, "--config", document, *options]) == status
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line


def test_a_carry_that_is_none_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, config = files(tmp_path, rows=50)
    carry = tmp_path / "carry.json"
    for document, words in (
        ({"mean": [1.0], "covariance": [], "t_s": 0}, "mean: has 1 numbers; 7 are needed"),
        ({"mean": [0.0] * 7, "covariance": [[0.0]], "t_s": 0}, "covariance: is no matrix"),
        ({"mean": [0.0] * 7, "covariance": (-np.eye(7)).tolist(), "t_s": 0}, "not the covariance of anything"),
    ):
        carry.write_text(json.dumps(document))
        assert main(["battery", data, "--config", config, "--carry", str(carry)]) == 1
        assert words in capsys.readouterr().err
