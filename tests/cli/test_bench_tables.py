"""The tables of what sensors are worth and of normalised errors, on a short drive."""

from __future__ import annotations

import numpy as np
import pytest

from app.cli.bench import degraded, nees
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation


def test_the_table_of_lost_sensors_has_a_row_for_each_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(degraded, "DURATION_S", 400.0)
    kept = {name: degraded.MODES[name] for name in ("all sensors", "no GPS", "garage, 4 minutes")}
    monkeypatch.setattr(degraded, "MODES", kept)
    figures = degraded.measure()
    head, full, blind, _ = degraded.layout(figures)
    assert head[:3] == ["sensors", "speed, m/s", "pitch, °"]
    assert full[0] == "all sensors"
    assert blind[4:6] == ["-", "-"]
    assert {figure.reference_name for figure in figures} == {"all sensors"}
    pitch = {f.name: f for f in figures}["no GPS: pitch"]
    assert pitch.reference < pitch.value


def test_normalised_errors_are_those_of_a_right_covariance() -> None:
    rng = np.random.default_rng(3)
    root = rng.standard_normal((4, 4))
    covariance = np.tile(root @ root.T, (5000, 1, 1))
    error = rng.standard_normal((5000, 4)) @ root.T
    assert nees._nees(error, covariance, [0, 1, 2, 3]).mean() == pytest.approx(4.0, rel=0.05)
    assert nees._nees(error, covariance, [2]).mean() == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("smooth", [False, True])
def test_the_observers_covariance_is_near_the_truth_of_a_drive(smooth: bool) -> None:
    found = nees.group_nees(simulate(Simulation(duration_s=400.0, seed=641)), smooth=smooth)
    assert set(found) == set(nees.GROUPS)
    for group in ("speed", "pitch", "speed, thrust and pitch"):
        assert 0.1 < found[group].mean() / len(nees.GROUPS[group]) < 2.5, group
