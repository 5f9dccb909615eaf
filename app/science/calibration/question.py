"""What is asked of several trips, and the words and grades that all answers share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.science.calibration.evidence import Combined, TripEvidence, combine
from app.science.calibration.proposal import Change, Confidence, Name, Proposal
from app.science.vehicle.elements import FIELD_OF
from app.science.vehicle.field import value_of
from app.science.vehicle.model import Vehicle

SIGNIFICANT_SDS = 3.0


@dataclass(frozen=True, slots=True)
class Question:
    """Trips, the car's file as it is, and what was filled in."""

    evidences: tuple[TripEvidence, ...]
    vehicle: Vehicle
    refuelled_l: float | Sequence[float | None] | None

    def combined(self, name: str) -> Combined | None:
        """Combine the trips' estimates of one name."""
        return combine(self.evidences, name)

    def unknown(self, name: Name, why: str = "") -> list[Proposal]:
        """Say what is missing: what is given, or else the trips' own reasons."""
        reasons = (
            [why]
            if why
            else sorted({evidence.missing[name] for evidence in self.evidences if name in evidence.missing})
        )
        label = SUBJECT[name]
        return [Proposal(name, (), tuple(f"{label} {reason}." for reason in reasons), "weak", 0)] if reasons else []


SUBJECT: dict[Name, str] = {
    "mounting": "The accelerometer's mounting",
    "accelerometer_scale": "The accelerometer's scale",
    "vss_m_per_tick": "The wheels' calibration",
    "injector_lag": "The injectors' lag",
    "injector_flow": "The injectors' flow",
    "accelerometer_bias": "The accelerometer's bias",
    "gps_latency": "The receiver's latency",
    "clock_skew": "The clock's skew",
    "road_load": "The road load",
}


def change(path: str, vehicle: Vehicle, after: float, sd: float, digits: int) -> Change:
    """Return a change of a field, from and to the form's unit, rounded to so many decimals."""
    field = FIELD_OF[path]
    before = value_of(vehicle, field.target)
    return Change(
        path,
        field.label,
        field.unit,
        float(before) / field.si if before is not None else None,
        round(after, digits),
        sd,
    )


def graded(sd: float, sure: float, likely: float) -> Confidence:
    """How much a proposal of that standard deviation is worth."""
    return "sure" if sd <= sure else "likely" if sd <= likely else "weak"
