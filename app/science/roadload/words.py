"""What stands in the way of a road load, and what to beware of, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.science.roadload.evidence import RoadLoadEvidence
    from app.science.roadload.identify import RoadLoad

NARROW_MPS = 6.0
SHORT_H = 1.0
KMH = 3.6


def reasons_of(found: RoadLoad) -> tuple[str, ...]:
    """Say why a value isn't identified, and what would help."""
    if found.model is None:
        return (
            "Mass, drag and rolling resistance can't be told: no trip knows both the engine's speed and its fuel or "
            "torque, at least every two seconds, for a minute of steady driving.",
        )
    reasons = []
    if found.cd_area_m2.value <= 0.0 or found.crr.value <= 0.0:
        reasons.append(
            "Driving would need a resistance that pushes: look at the gear ratios, the fuel's flow and the altitudes."
        )
    if not found.mass_kg.identified:
        told = (
            "the reported torque is itself not trusted better than the file's mass"
            if found.mass_kg.value != found.mass_kg.file
            else "without the engine's torque, mass, drag and efficiency can all be scaled together"
        )
        reasons.append(f"The mass rests on the car's file: {told}.")
    if not found.cd_area_m2.identified:
        reasons.append("Drag is not told well: drive longer, at motorway speeds and in more than one gear.")
    if not found.crr.identified:
        reasons.append(
            "Rolling resistance is not told well: drive longer, in town and in all gears, or coast in neutral."
        )
    return tuple(reasons)


def warnings_of(trips: Sequence[RoadLoadEvidence], coasting_windows: int) -> tuple[str, ...]:
    """Say what the numbers leave out."""
    if not trips:
        return ()
    warnings = ["Wind is taken as none and the air's density from the car's file: a steady wind looks like drag."]
    slowest, fastest = min(trip.speed_mps[0] for trip in trips), max(trip.speed_mps[1] for trip in trips)
    if fastest - slowest < NARROW_MPS:
        warnings.append(
            f"Nearly all driving was between {slowest * KMH:.0f} and {fastest * KMH:.0f} km/h: one speed can't tell "
            "drag from rolling resistance."
        )
    if coasting_windows == 0:
        warnings.append("The car never rolled with an open clutch, so the engine's own power had to be guessed along.")
    if sum(trip.seconds for trip in trips) < SHORT_H * 3600.0:
        warnings.append("This is less than an hour of steady driving.")
    return tuple(warnings)
