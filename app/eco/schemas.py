"""Shapes of the scores as the API shows them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from app.schemas import Document, Moment

TRIP_ID, CAR_ID = "6f1c2f0b8d8e4a0f9a52f1b6c0de0004", "6f1c2f0b8d8e4a0f9a52f1b6c0de0003"
NUMBERS = {"score": 86.1, "score_sd": 2.1, "fuel_l": 2.21, "saved_l": 0.31, "saved_sd_l": 0.05, "distance_m": 31200.0}
PART_EXAMPLE: dict[str, Any] = {
    "trip_id": TRIP_ID,
    "name": "To work",
    "started_at": "2026-02-27T07:41:00Z",
    **NUMBERS,
    "reason": "",
    "map_version": 7,
    "scored_at": "2026-02-27T08:12:00Z",
}
ADVICE = ["Shift up at 2500 rpm instead of 3400: 0.12 L"]
CAR_EXAMPLE: dict[str, Any] = NUMBERS | {
    "car_id": CAR_ID,
    "reason": "",
    "advice": ADVICE,
    "advice_trip_id": TRIP_ID,
    "newest_map_version": 8,
    "trips": [PART_EXAMPLE],
}
RANK_EXAMPLE: dict[str, Any] = NUMBERS | {
    "car_id": CAR_ID,
    "car_name": "Smart Roadster",
    "trip_id": None,
    "trip_name": None,
    "trips": 14,
}

Saved = Field(
    description="Litres of `fuel_l` that the best drives over the same roads in the same times don't take. A trip that "
    "measured no fuel counts with what the engine's model says it took."
)
Deviation = Field(
    description="One standard deviation, for the share saved; trips share their car's map, so theirs are added up."
)


class ScoredTrip(Document):
    """A trip's part in its car's score; ``reason`` says why it has none."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": PART_EXAMPLE})

    trip_id: str
    name: str
    started_at: Moment | None
    score: float | None
    score_sd: float | None
    fuel_l: float | None
    saved_l: float | None
    saved_sd_l: float | None
    distance_m: float | None
    reason: str
    map_version: int | None
    scored_at: Moment | None


class CarScore(Document):
    """How near to its best drives a car is driven: all its scored trips, each weighing as much as its fuel."""

    model_config = ConfigDict(json_schema_extra={"example": CAR_EXAMPLE})

    car_id: str
    score: float | None
    score_sd: float | None
    fuel_l: float | None
    saved_l: float | None = Saved
    saved_sd_l: float | None = Deviation
    distance_m: float | None
    reason: str = Field(description="Why there is no score yet, and what to do.")
    advice: list[str] = Field(description="What to do differently, from the latest trip that was scored.")
    advice_trip_id: str | None
    newest_map_version: int | None
    trips: list[ScoredTrip] = Field(description="All observed trips in the order they were driven.")


class Ranked(Document):
    """A car, or a trip, in the fleet's ranking."""

    model_config = ConfigDict(json_schema_extra={"example": RANK_EXAMPLE})

    car_id: str
    car_name: str
    trip_id: str | None
    trip_name: str | None
    trips: int
    score: float
    score_sd: float
    fuel_l: float
    saved_l: float = Saved
    saved_sd_l: float = Deviation
    distance_m: float


RankBy = Literal["car", "trip"]
