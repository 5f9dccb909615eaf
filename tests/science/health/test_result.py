"""A car's health goes through JSON and comes back as it was."""

from __future__ import annotations

import json

import pytest

from app.science.health.result import CarHealth, HealthAlert, Trend, TripChange, TripHealth

TRIP = TripHealth("t9", "trip 9", 1256629260.0, "watched", changes=(TripChange("rolling_resistance", 18.2, 3.1),))
EARLY = TripHealth("t1", "trip 1", None, "left_out", reason="It is too short.")
TREND = Trend(
    quantity="rolling_resistance",
    title="Rolling resistance",
    unit="%",
    trip_ids=("t9",),
    names=("trip 9",),
    started_at=(None,),
    estimate=(18.2,),
    sd=(3.1,),
    usual=0.0,
    usual_sd=0.8,
    band=6.4,
    change_points=("t9",),
    words="18 % above its usual.",
)
ALERT = HealthAlert(
    quantity="rolling_resistance",
    since_trip_id="t9",
    raised_trip_id="t9",
    last_trip_id="t9",
    cleared_trip_id=None,
    trips=1,
    change=18.2,
    change_sd=3.1,
    unit="%",
    chance=0.99,
    other="",
    words="Rolling resistance 18 % above its usual, since 1 trip",
    advice="Check the tyre pressures.",
)


def test_health_survives_json() -> None:
    health = CarHealth((EARLY, TRIP), (TREND,), (ALERT,), "One thing changed.", 0.2, 8, 8)
    assert CarHealth.from_dict(json.loads(json.dumps(health.to_dict()))) == health
    assert health.open_alerts == (ALERT,)


def test_a_document_of_another_version_is_refused() -> None:
    with pytest.raises(TypeError):
        CarHealth.from_dict({"trips": [], "mood": "good"})
