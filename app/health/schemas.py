"""Shapes of the cars' health as the API shows it."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import AwareDatetime, ConfigDict, Field

from app.schemas import Document, Moment

AlertStateName = Literal["open", "seen", "cleared"]
HealthState = Literal["unknown", "healthy", "alert"]

ALERT_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0005",
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "car_name": "Smart Roadster",
    "quantity": "rolling_resistance",
    "state": "open",
    "words": "Rolling resistance 18 % above its usual, since 3 trips",
    "advice": "Check the tyre pressures.",
    "change": 18.0,
    "change_sd": 4.0,
    "unit": "%",
    "chance": 0.97,
    "other": "",
    "trips": 3,
    "since_trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0004",
    "since_at": "2026-02-27T07:41:00Z",
    "seen_at": None,
    "seen_by": None,
    "cleared_at": None,
    "cleared_words": "",
    "created_at": "2026-03-01T08:12:00Z",
}


TRIP = {"trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0004", "name": "Tuesday"}
TREND_EXAMPLE: dict[str, Any] = {
    "quantity": "rolling_resistance",
    "title": "Rolling resistance",
    "unit": "%",
    "words": "Rolling resistance 18 % above its usual, since 3 trips.",
    "trip_ids": [TRIP["trip_id"]],
    "names": [TRIP["name"]],
    "estimate": [18.0],
    "sd": [4.0],
    "usual": 0.0,
    "usual_sd": 1.4,
    "band": 9.0,
    "change_points": [TRIP["trip_id"]],
}
IDLE_EXAMPLE: dict[str, Any] = TRIP | {"litres_per_hour": 0.39, "rpm": 847.0, "seconds": 74.0}
PART_EXAMPLE: dict[str, Any] = TRIP | {"started_at": "2026-02-27T07:41:00Z", "role": "watched", "why": ""}
USUAL_EXAMPLE: dict[str, Any] = {"usual_since": "2026-02-27T07:41:00Z", "job_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0001"}


class AlertDocument(Document):
    """A change of a car that is more than chance. ``chance`` is how probably this cause, and no other, is it."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": ALERT_EXAMPLE})

    id: str
    car_id: str
    car_name: str
    quantity: str
    state: AlertStateName
    words: str
    advice: str
    change: float
    change_sd: float
    unit: str
    chance: float
    other: str
    trips: int
    since_trip_id: str | None
    since_at: Moment
    seen_at: Moment | None
    seen_by: str | None
    cleared_at: Moment | None
    cleared_words: str
    created_at: Moment


class TrendDocument(Document):
    """One quantity over the trips that tell it, in driving order: how far it was from the car's usual."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": TREND_EXAMPLE})

    quantity: str
    title: str
    unit: str
    words: str
    trip_ids: list[str]
    names: list[str]
    estimate: list[float]
    sd: list[float]
    usual: float
    usual_sd: float
    band: float = Field(description="Two standard deviations of a healthy trip about the usual.")
    change_points: list[str]


class IdlePart(Document):
    """What a trip burnt standing still with its engine running."""

    model_config = ConfigDict(json_schema_extra={"example": IDLE_EXAMPLE})

    trip_id: str
    name: str
    litres_per_hour: float
    rpm: float
    seconds: float


class TripPart(Document):
    """What a trip is to the car's health; ``why`` says why it doesn't count, where it doesn't."""

    model_config = ConfigDict(json_schema_extra={"example": PART_EXAMPLE})

    trip_id: str
    name: str
    started_at: Moment | None
    role: Literal["baseline", "watched", "before", "left_out"]
    why: str


class HealthDocument(Document):
    """How a car is, as its trips tell it. ``reason`` says why nothing is known yet and what to do."""

    car_id: str
    state: HealthState
    words: str
    reason: str
    baseline_trips: int
    baseline_needed: int
    false_alarms_per_200_trips: float | None
    usual_since: Moment | None
    assessed_at: Moment | None
    code_version: str | None
    alerts: list[AlertDocument]
    trends: list[TrendDocument]
    idle: list[IdlePart] = Field(description="Shown only; no alarm is raised from it.")
    trips: list[TripPart]


class NewUsual(Document):
    """From when on the car's trips say what is usual: from a trip, from a moment, or where the open alert began."""

    model_config = ConfigDict(json_schema_extra={"example": {"since_trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0004"}})

    since_trip_id: str | None = Field(None, pattern="^[0-9a-f]{32}$")
    since: AwareDatetime | None = None


class UsualDocument(Document):
    """What came of it: from when on, and the job that assesses the car anew."""

    model_config = ConfigDict(json_schema_extra={"example": USUAL_EXAMPLE})

    usual_since: Moment | None
    job_id: str
