"""`battery-curve` from data to a configuration that `battery` takes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli.main import app
from tests.science.battery.made_cells import CIRCUIT, NMC, pulsed


@pytest.fixture
def data(tmp_path: Path) -> Path:
    record = pulsed(NMC)
    path = tmp_path / "pulses.csv"
    rows = np.column_stack([record.t_s, record.current_a, record.voltage_v])
    np.savetxt(path, rows, delimiter=",", header="t_s,current_a,voltage_v", comments="", fmt="%.5f")
    return path


def test_a_configuration_is_made_that_battery_takes(data: Path, tmp_path: Path) -> None:
    made = tmp_path / "config.json"
    done = CliRunner().invoke(app, ["battery-curve", str(data), "--out", str(made), "--json"])
    assert done.exit_code == 0, done.output
    (circuit,) = json.loads(done.stdout)["circuits"]
    assert circuit["resistance_ohm"] == pytest.approx(CIRCUIT.resistance_ohm, rel=0.05)
    config = json.loads(made.read_text(encoding="utf-8"))
    assert config["initial"]["capacity_ah"] == pytest.approx(5.0, rel=0.01)

    used = CliRunner().invoke(app, ["battery", str(data), "--config", str(made), "--json"])
    assert used.exit_code == 0, used.output
    assert json.loads(used.stdout)["capacity_ah"] == pytest.approx(5.0, rel=0.01)


def test_words_show_curve_circuit_and_capacity(data: Path) -> None:
    done = CliRunner().invoke(app, ["battery-curve", str(data), "--polynomial", "6", "--limits", "3.0", "4.19"])
    assert done.exit_code == 0, done.output
    assert all(word in done.stdout for word in ("SOC %", "circuit", "polynomial:", "capacity test", "warning:"))


def test_data_without_an_end_are_refused_in_a_line(data: Path) -> None:
    done = CliRunner().invoke(app, ["battery-curve", str(data), "--limits", "2.0", "4.9"])
    assert done.exit_code == 1
    assert "Give the" in str(done.exception)
    assert CliRunner().invoke(app, ["battery-curve", str(data), "--limits", "4.2", "3.0"]).exit_code == 2
