"""Bodies of the calibration's requests and answers."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from app.jobs.service import JobView
from app.schemas import Document, Moment

CALIBRATION_EXAMPLE: dict[str, Any] = {
    "key": "9c6f0c2f6d0b6d3f3a6a0c1f5f0f0a9c8d7e6f5a4b3c2d1e0f9a8b7c6d5e4f3a",
    "config_revision": 3,
    "proposals": [
        {
            "name": "vss_m_per_tick",
            "title": "Metres per wheel tick",
            "changes": [
                {
                    "field": "vss@mpt",
                    "label": "Metres per tick",
                    "unit": "m",
                    "before": 0.2702,
                    "after": 0.2688,
                    "sd": 0.0001,
                }
            ],
            "evidence": ["On 64 km the positions lie 0.5 % closer together than the wheels say."],
            "confidence": "sure",
            "trips": 3,
            "applicable": True,
        }
    ],
    "road_load": None,
    "trips": [
        {
            "trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0002",
            "name": "27 October",
            "started_at": "2009-10-27T07:41:00Z",
            "refuelled_l": None,
            "counts": True,
            "why": "",
            "missing": {},
        }
    ],
}


class ChangeDocument(Document):
    """One number: what the file says, and what driving says."""

    field: str = Field(description="Path in the car's form; empty for information only.")
    label: str
    unit: str
    before: float | None
    after: float
    sd: float = Field(description="Standard deviation of `after`.")


class ProposalDocument(Document):
    """Changes that are taken or left together."""

    name: str
    title: str
    changes: list[ChangeDocument]
    evidence: list[str]
    confidence: Literal["sure", "likely", "weak"]
    trips: int
    applicable: bool = Field(description="Whether it may be applied: it has fields of the file and is not weak.")


class TripSaysDocument(Document):
    """Whether a trip counts, and what it says nothing of."""

    trip_id: str
    name: str
    started_at: Moment | None
    refuelled_l: float | None
    counts: bool
    why: str = Field(description="Why it doesn't count.")
    missing: dict[str, str] = Field(description="Of what a trip that counts says nothing, and why.")


class ShareDocument(Document):
    """How much of what is known rests on one source."""

    source: Literal["prior", "coasting", "gravity", "acceleration", "cruising"]
    share: float


class IdentifiedDocument(Document):
    """One quantity: what the file says, and what driving makes of it."""

    file: float
    value: float
    sd: float = Field(description="Standard deviation of `value`.")
    identified: bool = Field(description="Whether driving tells it, or the file alone.")
    shares: list[ShareDocument]


class BestPointDocument(Document):
    """The engine's best point with the file's road load and with the new one."""

    rpm: float
    before: float
    after: float
    nm_before: float
    nm_after: float


class AtLoadDocument(Document):
    """Efficiency at one load."""

    fuel_power_w: float
    before: float
    after: float


class LevelsDocument(Document):
    """The engine's efficiency with the file's road load and with the new one."""

    before: float
    after: float
    best: BestPointDocument | None
    by_load: list[AtLoadDocument]


class RoadLoadDocument(Document):
    """Mass, drag and rolling resistance from driving; see docs/health.md."""

    model: Literal["fuel", "torque"] | None = Field(description="What the engine's force was taken from.")
    mass_kg: IdentifiedDocument
    cd_area_m2: IdentifiedDocument = Field(description="C_d·A; its sd includes the mass'.")
    cd_area_sd_given_mass_m2: float
    crr: IdentifiedDocument
    correlation: float = Field(description="Of the errors of drag and rolling resistance.")
    trips: int
    driving_windows: int
    coasting_windows: int
    hours: float
    levels: LevelsDocument | None
    reasons: list[str]
    warnings: list[str]


class CalibrationDocument(Document):
    """What a car's trips say of its file; proposals are never made by themselves."""

    model_config = ConfigDict(json_schema_extra={"example": CALIBRATION_EXAMPLE})

    key: str = Field(description="Names file and proposals; give it to `apply`, which then refuses anything else.")
    config_revision: int
    proposals: list[ProposalDocument]
    road_load: RoadLoadDocument | None = Field(description="Null where no trip tells of it.")
    trips: list[TripSaysDocument]


class ApplyProposals(Document):
    """Which proposals to write into the car's file."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"names": ["vss_m_per_tick"]}})

    names: list[Annotated[str, Field(max_length=40)]] = Field(min_length=1, max_length=20)
    key: Annotated[str, Field(max_length=64)] | None = None


class AppliedDocument(Document):
    """The new revision of the car's file, where it came from, and the jobs that run the trips again."""

    revision: int
    note: str
    jobs: list[JobView]
