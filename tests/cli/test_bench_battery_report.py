"""The benchmark of the report's estimator on one short battery."""

import pytest

from app.cli.bench import battery_report


def test_it_measures_speed_closeness_and_honesty(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {"SEEDS": (9701,), "DAYS": 1.5, "LONG_DAYS": 1.6, "PLAIN_ROWS": 50}.items():
        monkeypatch.setattr(battery_report, name, value)
    figures = {figure.name: figure for figure in battery_report.measure()}
    assert len(figures) == 4 + 3 * 5 + 2
    assert figures["least squares: capacity, largest of 1 errors"].value < 0.5
    assert figures["gPC, N = 3: capacity, largest of 1 errors"].reference == pytest.approx(10.0)
    assert 50.0 < figures["least squares: truth within two standard deviations"].value <= 100.0
    assert figures["gPC, N = 3: capacity with a current sensor 5 mA off"].value > 0.2
