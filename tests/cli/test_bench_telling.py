"""``./ponthy bench observability`` on a few minutes instead of an hour."""

from __future__ import annotations

import pytest

from app.cli.bench import telling
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation


def test_heights_tell_the_slope_from_the_bias(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(telling, "virtual_hour", lambda: simulate(Simulation(duration_s=240.0, seed=5)))
    figures = {figure.name: figure for figure in telling.measure()}
    pitch, bias = (
        [figures[f"{sensors}: {name} that a minute leaves open"].value for sensors in ("GPS + elevation", "neither")]
        for name in ("pitch", "accelerometer bias forward")
    )
    assert pitch[0] < 0.1 * pitch[1]
    assert bias[0] < bias[1]
    assert all(figure.value <= figure.reference for figure in figures.values() if "leaves open" in figure.name)
