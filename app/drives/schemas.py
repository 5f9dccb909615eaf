"""Shapes of the drives as the API shows them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, FiniteFloat, model_validator

from app.schemas import Document, Line, Moment, Name

MOST_ROAD_POINTS = 20_000
DriveState = Literal["waiting", "solving", "solved", "infeasible", "failed", "cancelled"]

ACCELERATE: dict[str, Any] = {
    "kind": "accelerate",
    "vehicle": {
        "mass_kg": 920,
        "accelerated_mass_kg": 948,
        "cd": 0.39,
        "frontal_area_m2": 1.93,
        "crr": 0.010,
        "air_density_kgpm3": 1.2,
        "gravity_mps2": 9.805,
        "wheel_radius_m": 0.2954,
    },
    "engine": {
        "phi": [9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04],
        "speed_rpm": [1000, 6000],
        "torque_nm": [10, 100],
    },
    "transmission": {"type": "gears", "ratios": [13.25, 9.604, 7.37, 5.796, 4.208, 3.23]},
    "from_speed_mps": 10.0,
    "to_speed_mps": 27.7778,
    "time_s": None,
}
"""The thesis' car (Sebesta 2010, 4.4)."""

DRIVE_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0005",
    "name": "36 to 100 km/h",
    "kind": "accelerate",
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "car_name": "Grey roadster",
    "map": {"car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003", "version": 14},
    "state": "solved",
    "job_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0001",
    "jobs": {"solve": "6f1c2f0b8d8e4a0f9a52f1b6c0de0001", "compare": None, "front": None},
    "failure": None,
    "fuel_energy_j": 1104829.0,
    "time_s": 9.32,
    "distance_m": 171.6,
    "verdict": "optimal",
    "problem_sha256": "9c6f0c2f6d0b6d3f3a6a0c1f5f0f0a9c8d7e6f5a4b3c2d1e0f9a8b7c6d5e4f3a",
    "created_at": "2026-03-01T08:12:00Z",
}
WHOLE_EXAMPLE = DRIVE_EXAMPLE | {"problem": ACCELERATE, "engine": None, "answer": None}


class JobsOfDrive(Document):
    """The newest job of each kind, null where none was asked for."""

    solve: str | None = None
    compare: str | None = None
    front: str | None = None


class DriveView(Document):
    """A drive in short. ``job_id`` is the job that solves it; numbers are null until it has."""

    model_config = ConfigDict(json_schema_extra={"example": DRIVE_EXAMPLE})

    id: str
    name: str
    kind: str
    car_id: str | None
    car_name: str | None
    map: dict[str, Any] | None = Field(
        description="The version of a car's map that the engine became, if it names one."
    )
    state: DriveState
    job_id: str | None
    jobs: JobsOfDrive
    failure: dict[str, Any] | None = Field(description="Why there is no answer, as a problem document (RFC 9457).")
    fuel_energy_j: float | None
    time_s: float | None
    distance_m: float | None
    verdict: str | None
    problem_sha256: str
    created_at: Moment


class WholeDrive(DriveView):
    """A drive with its problem as it was posed; with its answer where that was waited for."""

    model_config = ConfigDict(json_schema_extra={"example": WHOLE_EXAMPLE})

    problem: dict[str, Any]
    engine: dict[str, Any] | None = Field(description="What an engine that names a map became.")
    answer: dict[str, Any] | None = None


class NewDrive(Document):
    """A problem to be solved, as `./ponthy drive` takes it; a bare problem document will do, too."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"problem": ACCELERATE}})

    name: Name | None = Field(None, description="Unset: what the drive does, such as `36 to 100 km/h`.")
    car_id: Annotated[str, Field(pattern="^[0-9a-f]{32}$")] | None = Field(
        None, description="The car it is for; unset: the one whose map the engine names."
    )
    problem: dict[str, Any]


def as_posed(body: Any) -> Any:
    """Take a problem document on its own for a drive without a name or a car."""
    return {"problem": body} if isinstance(body, dict) and "kind" in body and "problem" not in body else body


class CheckedProblem(Document):
    """A problem that can be read: its kind, what a drive of it would be called, and what to know beforehand."""

    model_config = ConfigDict(
        json_schema_extra={"example": {"kind": "accelerate", "name": "36 to 100 km/h", "warnings": []}}
    )

    kind: str
    name: str
    warnings: list[str]


class RoadAsked(Document):
    """A road that is there already: a trip's, or the `road` of a problem."""

    model_config = ConfigDict(extra="forbid")

    trip_id: Annotated[str, Field(pattern="^[0-9a-f]{32}$")] | None = None
    from_s: float = Field(0.0, ge=0)
    to_s: float = Field(1e9, ge=0)
    distance_m: list[FiniteFloat] = Field(default_factory=list, max_length=MOST_ROAD_POINTS)
    elevation_m: list[FiniteFloat] = Field(default_factory=list, max_length=MOST_ROAD_POINTS)
    speed_limit_mps: list[FiniteFloat] = Field(default_factory=list, max_length=MOST_ROAD_POINTS)

    @model_validator(mode="after")
    def _is_a_road(self) -> RoadAsked:
        lengths = {len(self.distance_m), len(self.elevation_m), len(self.speed_limit_mps)}
        if self.trip_id is None and (len(lengths) > 1 or lengths <= {0, 1}):
            raise ValueError(
                "give a trip_id, or distance_m, elevation_m and speed_limit_mps of two points or more each"
            )
        return self


def road_alone(body: Any) -> Any:
    """Take a problem's road out of what `./ponthy road --json` says of it."""
    return body["road"] if isinstance(body, dict) and "road" in body else body


class DriveChange(Document):
    """What may be changed of a drive."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"name": "Up the pass"}})

    name: Name


class CompareWish(Document):
    """Which methods are to be compared."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"methods": ["pontryagin", "dp_speed"]}})

    methods: list[Line] | None = Field(None, min_length=1, max_length=40, description="Unset: all that apply.")


OnAxis = Annotated[Line, Field(min_length=1, max_length=80)]


class FrontWish(Document):
    """What fuel is to be weighed against."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"emission": "nox", "points": 9}})

    emission: OnAxis = Field(description="One that the problem's `cost` has a map of, `co2`, or `time`.")
    points: int = Field(9, ge=2, le=50)
    against: OnAxis = Field("fuel", description="The other axis: `fuel`, or another emission.")
