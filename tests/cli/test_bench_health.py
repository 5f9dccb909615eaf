"""``./ponthy bench health`` on one car with short trips."""

from __future__ import annotations

import pytest

from app.cli.bench import car_health
from app.cli.bench.car_health import FAULTS, SUBJECTS, healthy_and_faulty, measure


@pytest.mark.slow
def test_a_load_is_found_and_a_healthy_car_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(car_health, "DURATION_S", 600.0)
    monkeypatch.setattr(car_health, "FAULTS", [fault for fault in FAULTS if fault.quantity == "mass"])
    false_alarms, found = healthy_and_faulty(SUBJECTS[0], healthy=2, faulty=2)
    (load,) = found.values()
    assert false_alarms == 0
    assert load.alert is not None
    assert (load.alert.quantity, load.alert.since_trip_id) == ("mass", "10")
    assert load.alert.change == pytest.approx(150.0, abs=40.0)


def test_figures_count_cars(monkeypatch: pytest.MonkeyPatch) -> None:
    """A car on which nothing was found counts against the share, and every figure has a ratio."""
    missed = {fault.name: car_health.Found(None, None) for fault in FAULTS}
    monkeypatch.setattr(car_health, "healthy_and_faulty", lambda *_: (1, missed))
    figures = {figure.name: figure for figure in measure()}
    quiet = figures["healthy trips without a false alarm"]
    assert quiet.reference - quiet.value == len(SUBJECTS)
    assert all(0.0 <= figure.ratio <= 1.0 for figure in figures.values())
    assert figures["C_rr +20 %: found and named rightly"].value == 0
