"""``./ponthy battery-track``: a life of discharges in one table, and what is said of a wrong column."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.cli.main import main
from tests.science.battery.made_cells import CIRCUIT
from tests.science.battery.test_tracking import discharge

CALL = ["--limits", "3.05", "4.19", "--resistance-ohm", str(CIRCUIT.resistance_ohm)]
CALL += ["--relaxation-ohm", str(CIRCUIT.relaxation_resistance_ohm), "--time-constant-s", str(CIRCUIT.time_constant_s)]


def life(folder: Path) -> str:
    """Return a table of three full discharges and three partial ones, a few percent smaller each."""
    lines = ["turn,t_s,current_a,voltage_v"]
    for k, share in enumerate([1.05, 1.05, 1.05, 0.55, 0.55, 0.55]):
        record = discharge(5.0 - 0.05 * k, 0.02, share, k)
        columns = (record.t_s, record.current_a, record.voltage_v)
        lines += [f"turn {k},{t:g},{a:.5f},{v:.5f}" for t, a, v in zip(*columns, strict=True)]
    file = folder / "life.csv"
    file.write_text("\n".join([*lines, ""]))
    return str(file)


def test_discharges_of_one_table_are_followed_in_order(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["battery-track", life(tmp_path), "--by", "turn", *CALL, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["discharges"]
    assert [one["discharge"] for one in told] == [f"turn {k}" for k in range(6)]
    assert [one["measured"] for one in told] == [True] * 3 + [False] * 3
    shrinking = np.array([one["capacity_ah"] for one in told]) / told[0]["capacity_ah"]
    np.testing.assert_allclose(shrinking, 1.0 - 0.01 * np.arange(6), atol=0.015)


def test_a_wrong_column_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["battery-track", life(tmp_path), "--by", "cycle", *CALL]) == 1
    assert "no column cycle; the table has turn, t_s" in capsys.readouterr().err
