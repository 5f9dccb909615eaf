"""Shapes of the batteries as the API takes and shows them."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field

from app.jobs.service import JobView
from app.schemas import Document, Line, Moment, Name

CONFIG_EXAMPLE: dict[str, Any] = {
    "ocv": [[0.0, 3.0], [0.1, 3.2], [0.5, 3.31], [0.9, 3.36], [1.0, 3.55]],
    "initial": {
        "capacity_ah": 2.0,
        "resistance_ohm": 0.01,
        "relaxation_capacitance_f": 2000.0,
        "relaxation_resistance_ohm": 0.015,
        "soc": 0.5,
    },
    "estimator": "ekf_bias",
    "series": 1,
    "parallel": 1,
}
BATTERY_ID, CAR_ID = "6f1c2f0b8d8e4a0f9a52f1b6c0de0021", "6f1c2f0b8d8e4a0f9a52f1b6c0de0003"
FILE_ID, ESTIMATE_ID = "6f1c2f0b8d8e4a0f9a52f1b6c0de0022", "6f1c2f0b8d8e4a0f9a52f1b6c0de0023"
JOB_ID = "6f1c2f0b8d8e4a0f9a52f1b6c0de0024"
ESTIMATE_EXAMPLE: dict[str, Any] = {
    "id": ESTIMATE_ID,
    "battery_id": BATTERY_ID,
    "trip_id": None,
    "file_id": FILE_ID,
    "source": "commute.csv",
    "began_at": "2026-03-01T07:41:00Z",
    "ended_at": "2026-03-01T08:20:00Z",
    "reason": "",
    "estimator": "ekf_bias",
    "capacity_ah": 1.94,
    "capacity_ah_sd": 0.02,
    "resistance_ohm": 0.0103,
    "resistance_ohm_sd": 0.0001,
    "relaxation_capacitance_f": 1950.0,
    "relaxation_capacitance_f_sd": 60.0,
    "relaxation_resistance_ohm": 0.0152,
    "relaxation_resistance_ohm_sd": 0.0003,
    "soc": 0.62,
    "soc_sd": 0.008,
    "soh": 0.97,
    "soh_sd": 0.01,
    "current_bias_a": 0.003,
    "current_bias_a_sd": 0.002,
    "voltage_rms_v": 0.0021,
    "voltage_noise_v": 0.002,
    "charge_ah": 1.1,
    "follows_id": None,
    "warnings": [],
    "made_at": "2026-03-01T08:21:00Z",
}
BATTERY_EXAMPLE: dict[str, Any] = {
    "id": BATTERY_ID,
    "car_id": CAR_ID,
    "car_name": "Blue hatchback",
    "name": "Traction battery",
    "end_of_life": 0.8,
    "series": 1,
    "parallel": 1,
    "rated_capacity_ah": 2.0,
    "estimator": "ekf_bias",
    "missing": [],
    "config_revision": 3,
    "estimates": 1,
    "newest": ESTIMATE_EXAMPLE,
    "job_id": None,
    "created_at": "2026-02-27T18:40:00Z",
}
FILE_EXAMPLE: dict[str, Any] = {
    "id": FILE_ID,
    "battery_id": BATTERY_ID,
    "work": "estimate",
    "name": "commute.csv",
    "sha256": "0e5751c026e543b2e8ab2eb06099daa1d1e5df47778f7787faab45cdf12fe3a8",
    "size": 81234,
    "began_at": "2026-03-01T07:41:00Z",
    "job_id": JOB_ID,
    "state": "succeeded",
    "problem": None,
    "estimate_id": ESTIMATE_ID,
    "created_at": "2026-03-01T08:20:40Z",
}
TEST_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0025",
    "battery_id": BATTERY_ID,
    "at": "2026-02-20T12:00:00Z",
    "capacity_ah": 1.95,
    "capacity_ah_sd": 0.01,
    "note": "1C at 25 °C",
    "created_at": "2026-02-21T09:00:00Z",
}

MOST_AH = 1e6
Config = Annotated[dict[str, Any], Field(description="A configuration as `./ponthy battery --config` takes it.")]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]


def _aware(moment: datetime) -> datetime:
    if not 1900 < moment.year < 3000:
        raise ValueError("is no time at which a battery was measured; years from 1901 to 2999 are")
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


At = Annotated[datetime, AfterValidator(_aware)]
"""A moment; one without a zone is UTC."""


class NewBattery(Document):
    """A battery for a car, with its configuration, which becomes the `<battery>` of the car's XML."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"car_id": CAR_ID, "config": CONFIG_EXAMPLE}}
    )

    car_id: Annotated[str, Field(pattern="^[0-9a-f]{32}$")]
    name: Name | None = None
    config: Config
    end_of_life: Share | None = None


class BatteryChange(Document):
    """What to change about a battery; what is left out stays."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"name": "Traction battery"}})

    name: Name | None = None
    end_of_life: Share | None = Field(None, description="Share of the rated capacity down to which it serves.")


class EstimateView(Document):
    """What one trip or file says of a battery, with standard deviations; ``reason`` tells why it says nothing.

    Everything is of one cell. ``charge_ah`` is what went through it, in and out; ``follows_id`` is the estimate before.
    """

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": ESTIMATE_EXAMPLE})

    id: str
    battery_id: str
    trip_id: str | None
    file_id: str | None
    source: str
    began_at: Moment
    ended_at: Moment
    reason: str
    estimator: str
    capacity_ah: float | None
    capacity_ah_sd: float | None
    resistance_ohm: float | None
    resistance_ohm_sd: float | None
    relaxation_capacitance_f: float | None
    relaxation_capacitance_f_sd: float | None
    relaxation_resistance_ohm: float | None
    relaxation_resistance_ohm_sd: float | None
    soc: float | None
    soc_sd: float | None
    soh: float | None
    soh_sd: float | None
    current_bias_a: float | None
    current_bias_a_sd: float | None
    voltage_rms_v: float | None
    voltage_noise_v: float | None
    charge_ah: float | None
    follows_id: str | None
    warnings: list[str]
    made_at: Moment


class BatteryView(Document):
    """A battery: what the car's file says of it, what is missing there, and its latest estimate."""

    model_config = ConfigDict(json_schema_extra={"example": BATTERY_EXAMPLE})

    id: str
    car_id: str
    car_name: str
    name: str
    end_of_life: float | None
    series: int | None
    parallel: int | None
    rated_capacity_ah: float | None
    estimator: str | None
    missing: list[str] = Field(description="What the car's file lacks for an estimate, in words.")
    config_revision: int
    estimates: int = Field(description="How many trips and files have told something.")
    newest: EstimateView | None
    job_id: str | None = Field(description="The newest job about this battery.")
    created_at: Moment


class FileView(Document):
    """A file that was sent for a battery, and what became of it; ``work`` is `estimate` or `curve`."""

    model_config = ConfigDict(json_schema_extra={"example": FILE_EXAMPLE})

    id: str
    battery_id: str
    work: str
    name: str
    sha256: str
    size: int
    began_at: Moment | None
    job_id: str | None
    state: str | None = Field(description="Of the job.")
    problem: dict[str, Any] | None
    estimate_id: str | None
    created_at: Moment


class Received(Document):
    """What became of a file: the job that works on it; or, for bytes that were there, the estimate they gave."""

    file: FileView
    job: JobView | None
    estimate: EstimateView | None
    duplicate: bool = Field(description="Whether the very same bytes were sent before.")


class NewCapacityTest(Document):
    """A capacity that a laboratory measured, of one cell as the configuration counts cells."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"example": {"at": "2026-02-20T12:00:00Z", "capacity_ah": 1.95, "capacity_ah_sd": 0.01}},
    )

    at: At
    capacity_ah: Annotated[float, Field(gt=0.0, le=MOST_AH, allow_inf_nan=False)]
    capacity_ah_sd: Annotated[float, Field(gt=0.0, le=MOST_AH, allow_inf_nan=False)] | None = None
    note: Annotated[Line, Field(max_length=500)] = ""


class CapacityTestView(Document):
    """A capacity that a laboratory measured."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": TEST_EXAMPLE})

    id: str
    battery_id: str
    at: Moment
    capacity_ah: float
    capacity_ah_sd: float | None
    note: str
    created_at: Moment
