"""Shapes of the tables that are laid over a car's maps."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from app.jobs.service import JobView
from app.maps.referencing import OTHER_REASONS, Beside, Correction
from app.schemas import Document, Moment

FuelName = Literal["petrol", "diesel", "e10", "e85", "lpg"]
REFERENCE_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0009",
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "name": "Dynamometer, May",
    "filename": "bench.csv",
    "fuel": "petrol",
    "sha256": "9f2c81b74d1e5a60c3d8f7e2b1a094837f6e5d4c3b2a190817263544fedcba98",
    "points": 99,
    "created_at": "2026-05-04T09:30:00Z",
}
KEY_EXAMPLE = "9f2c81b74d1e5a60c3d8f7e2b1a094837f6e5d4c3b2a190817263544fedcba98"


class ReferenceView(Document):
    """A table of a dynamometer or a manufacturer."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": REFERENCE_EXAMPLE})

    id: str
    car_id: str
    name: str
    filename: str
    fuel: FuelName
    sha256: str
    points: int = Field(description="Rows that can be used.")
    created_at: Moment


class LevelView(Document):
    """The flow of the injectors that would bring the map's level to the table's."""

    before: float = Field(description="As the car's file has it, l/s.")
    after: float
    sd: float
    impossible: str = Field(description="Why it can't be corrected so; empty when it can.")
    key: str = Field(description="Names what was looked at; give it back to apply the correction.")


class AgreementView(Document):
    """How a version of a car's map lies beside a table."""

    reference: ReferenceView
    version: int
    cells: int = Field(description="Trusted cells inside the table.")
    scale: float = Field(description="Factor from the table to the map.")
    scale_sd: float = Field(description="By how the factor differs over the map.")
    correlation: float = Field(description="Of the two shapes, −1 to 1.")
    peak_rpm: float = Field(description="From the table's best point to the map's.")
    peak_nm: float
    rmse: float = Field(description="Difference of efficiency, root mean square.")
    rmse_scaled: float = Field(description="The same with the level brought to the table's.")
    level: LevelView
    other_reasons: list[str] = Field(description="What else could explain a level that is off.")

    @classmethod
    def of(cls, found: Beside, correction: Correction) -> AgreementView:
        """Return the view of a table beside a map."""
        one = found.agreement
        return cls(
            reference=ReferenceView.model_validate(found.row),
            version=found.version.version,
            cells=one.cells,
            scale=one.scale,
            scale_sd=one.scale_sd,
            correlation=one.correlation,
            peak_rpm=one.peak_rpm,
            peak_nm=one.peak_nm,
            rmse=one.rmse,
            rmse_scaled=one.rmse_scaled,
            level=LevelView.model_validate(correction),
            other_reasons=list(OTHER_REASONS),
        )


class ApplyLevel(Document):
    """The word that the level is to be corrected."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"version": 14, "key": KEY_EXAMPLE}})

    version: int = Field(ge=1, le=1_000_000)
    key: str = Field(max_length=64, description="Of the agreement that was looked at.")


class LevelApplied(Document):
    """What came of it."""

    revision: int
    note: str
    jobs: list[JobView]
