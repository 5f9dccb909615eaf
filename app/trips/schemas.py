"""Shapes of the trips as the API shows and takes them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, computed_field

from app.schemas import Document, Moment, Name
from app.science.observer.sensor_words import sensor_words

TRIP_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0002",
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "car_name": "Smart Roadster, grey",
    "name": "27 October",
    "filename": "27-october.dat",
    "segment": 0,
    "state": "ready",
    "in_map": True,
    "notes": "",
    "started_at": "2009-10-27T07:41:00Z",
    "duration_s": 3480.2,
    "distance_m": 79900.0,
    "fuel_l": 4.2,
    "fuel_energy_j": 134400000.0,
    "refuelled_l": None,
    "verdict": "healthy",
    "reasons": ["every sensor agrees with the others within its stated noise"],
    "warnings": [],
    "filter": "ekf",
    "tuning": "default",
    "smoothed": True,
    "code_version": "0.1.0+3f9d2b61c0aa",
    "provenance": {"input_sha256": "…"},
    "summary": {"events": 537046},
    "job_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0001",
    "problem": None,
    "created_at": "2026-03-01T08:00:00Z",
}
TripState = Literal["waiting", "decoding", "observing", "mapping", "assessing", "ready", "failed"]
SensorName = Literal["gps", "dem", "acc", "vss", "inj"]
FilterName = Literal["ekf", "rk4-ekf", "dd-ekf", "sr-ekf", "ukf", "sr-ukf", "aekf"]


class TripView(Document):
    """A trip with the newest result of the observer.

    ``state`` follows the trip's newest job. A run that failed leaves the results of the run before; ``problem`` says
    what went wrong with the newest.
    """

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": TRIP_EXAMPLE})

    id: str
    car_id: str
    car_name: str
    name: str
    filename: str
    segment: int
    state: TripState
    in_map: bool
    notes: str
    started_at: Moment | None
    duration_s: float | None
    distance_m: float | None
    fuel_l: float | None
    fuel_energy_j: float | None
    refuelled_l: float | None
    verdict: str | None
    reasons: list[str]
    warnings: list[str]
    filter: str | None
    tuning: str | None
    smoothed: bool | None
    code_version: str | None
    provenance: dict[str, Any]
    summary: dict[str, Any]
    job_id: str | None
    problem: dict[str, Any] | None
    created_at: Moment


class TripChange(BaseModel):
    """What of a trip can be changed; what is left out stays as it is."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"in_map": False, "notes": "roof box"}})

    name: Name | None = None
    notes: Annotated[str, Field(max_length=20_000)] | None = None
    in_map: bool | None = None
    refuelled_l: Annotated[
        float | None,
        Field(ge=0, le=2000, allow_inf_nan=False, description="What filled the tank up right after; 0 forgets it."),
    ] = None


class Reprocessing(BaseModel):
    """How to observe a trip again.

    ``filter`` is one of the thesis' filters; ``tuning`` is the name of a preset, or an object of entries as in a
    tuning file; ``without`` leaves sensors out; without ``carry_over`` the accelerometer's biases start unknown
    instead of from the car's earlier trips.
    """

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"filter": "ukf", "tuning": "thesis-2010"}})

    filter: FilterName = "ekf"
    tuning: str | dict[str, float | str] = "default"
    smooth: bool = True
    without: list[SensorName] = []
    carry_over: bool = True


class RefusalView(Document):
    """A time in which a sensor's measurements were refused, and whether it was believed in the end."""

    from_s: float
    to_s: float
    count: int
    recovered: bool


class SensorRow(Document):
    """How well one sensor agrees with the filter's own uncertainty.

    ``nis_low`` and ``nis_high`` bound 95 % of the mean NIS of a right filter, for ``effective_count`` independent
    measurements; ``lag1`` and ``portmanteau`` tell whether innovations are white (0 and 1); ``bias`` is the mean
    normalised innovation. Numbers that an earlier version did not keep are null.
    """

    sensor: str
    count: int
    rejected: int
    nis_mean: float | None
    within_two_sigma: float | None
    within_one_sigma: float | None = None
    nis_low: float | None = None
    nis_high: float | None = None
    effective_count: float | None = None
    lag1: float | None = None
    portmanteau: float | None = None
    bias: float | None = None
    bias_sd: float | None = None
    recovered: int | None = None
    episodes: Annotated[list[RefusalView], Field(default_factory=list)]
    episode_count: int | None = None
    longest_refusal_s: float | None = None

    @computed_field
    def words(self) -> str:
        """What people call the sensor."""
        return sensor_words(self.sensor)


class Trace(BaseModel):
    """One quantity over time, decimated so that no extreme is lost; null where it is not known."""

    t_s: list[float]
    value: list[float | None]
    sd: list[float | None] | None
    unit: str


TRACES_EXAMPLE: dict[str, Any] = {
    "signals": {
        "speed_mps": {"t_s": [0.0, 0.05], "value": [12.5, 12.6], "sd": [0.02, 0.02], "unit": "m/s"},
    },
    "shown": 2,
    "total": 2,
    "from_s": 0.0,
    "to_s": 0.05,
}


class Traces(BaseModel):
    """Several quantities over time: ``shown`` of ``total`` samples of each."""

    model_config = ConfigDict(json_schema_extra={"example": TRACES_EXAMPLE})

    signals: dict[str, Trace]
    shown: int
    total: int
    from_s: float
    to_s: float


When = Literal["always", "changing", "never"]


class SensorLoss(BaseModel):
    """What is told of each state when these sensors are lost; none is the whole set.

    ``moving``: ``always`` on the move, only while speed, direction and slope are ``changing``, or ``never``.
    """

    lost: list[str]
    words: str
    moving: dict[str, When]
    standing: dict[str, bool]


class StateInformation(BaseModel):
    """What each window of the trip tells of a state by itself.

    ``sd`` is what it leaves of ``prior_sd``, window by window; ``told_share`` is the share of windows that leave less
    than a fifth.
    """

    prior_sd: float
    median_sd: float
    told_share: float
    sd: list[float]


OBSERVABILITY_EXAMPLE: dict[str, Any] = {
    "sensors": ["vss", "gps"],
    "measurements": ["vss", "gps_north", "gps_east"],
    "losses": [
        {
            "lost": ["vss"],
            "words": "Without wheel ticks, distance is no longer told.",
            "moving": {"distance_m": "never", "speed_mps": "always"},
            "standing": {"distance_m": False, "speed_mps": True},
        }
    ],
    "window_s": 60.0,
    "begin_s": [0.0, 60.0],
    "states": {"speed_mps": {"prior_sd": 15.0, "median_sd": 0.04, "told_share": 1.0, "sd": [0.05, 0.03]}},
}


class Observability(BaseModel):
    """What the sensors of a trip tell of the 17 states, by the names of the columns of ``states.parquet``."""

    model_config = ConfigDict(json_schema_extra={"example": OBSERVABILITY_EXAMPLE})

    sensors: list[str]
    measurements: list[str]
    losses: list[SensorLoss]
    window_s: float
    begin_s: list[float]
    states: dict[str, StateInformation]
