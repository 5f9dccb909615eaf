"""Figures of a battery, made on request from what is stored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import Query
from sqlalchemy.orm import Session

from app.batteries import repository, service
from app.batteries.ageing import ageing_document, rated_and_end
from app.batteries.models import Battery, BatteryEstimate
from app.batteries.results import answer_of, latest
from app.errors import PonthyError
from app.figures.battery import BatteryFigure, battery_figure
from app.figures.battery_documents import DrawnBattery, HealthMark, LaboratoryMark
from app.figures.theme import Json, theme_named
from app.science.arrays import FloatArray
from app.storage.blobs import Blobs
from app.trips import service as trips

EstimateId = Annotated[str | None, Query(pattern="^[0-9a-f]{32}$", description="Of this estimate; else the latest.")]
Threshold = Annotated[
    float | None, Query(ge=0.05, le=1.0, description="End of life as a share of the rated capacity; else the XML's.")
]

TOLD = "battery_soc"
"""The signal by which a car tells the state of charge itself."""


@dataclass(frozen=True, slots=True)
class Wish:
    """What of a figure can be chosen.

    Attributes
    ----------
    estimate : str or None
    threshold : float or None
    theme : {"light", "dark"}
    """

    estimate: EstimateId = None
    threshold: Threshold = None
    theme: Literal["light", "dark"] = "light"


def draw(session: Session, blobs: Blobs, battery: Battery, name: BatteryFigure, wish: Wish) -> Json:
    """Return a figure; raises `NotFound` for an estimate that isn't there, `Conflict` for one that says nothing."""
    chosen = latest(session, battery) if wish.estimate is None else service.estimate(session, battery.id, wish.estimate)
    rated, end_of_life = rated_and_end(session, battery)
    threshold = wish.threshold or end_of_life
    drawn = DrawnBattery(
        answer=None if chosen is None else answer_of(blobs, chosen),
        config=_config(session, battery),
        marks=_marks(session, battery),
        tests=_tests(session, battery, rated),
        ageing=ageing_document(session, battery, threshold) if name == "ageing" else None,
        threshold=threshold,
        told=_told(session, blobs, chosen) if name == "soc" else None,
    )
    return battery_figure(name, drawn, theme=theme_named(wish.theme))


def _told(session: Session, blobs: Blobs, chosen: BatteryEstimate | None) -> tuple[FloatArray, FloatArray] | None:
    """Return the state of charge that a trip's car told, where it did."""
    if chosen is None or chosen.trip_id is None:
        return None
    trip = trips.decoded_trip(session, chosen.trip_id)
    if trip is None:
        return None
    try:
        recording = trips.signals_of(blobs, trip, [TOLD])
    except FileNotFoundError:  # the trip is being decoded anew: the figure does without
        return None
    return (recording[TOLD].t_s, recording[TOLD].value) if TOLD in recording else None


def _config(session: Session, battery: Battery) -> dict[str, Any] | None:
    try:
        return service.config(session, battery.id)
    except PonthyError:  # taken out of the car's file: figures do without its curve
        return None


def _marks(session: Session, battery: Battery) -> list[HealthMark]:
    return [
        HealthMark(one.ended_at.timestamp(), one.source, one.soh, one.soh_sd, one.id)
        for one in repository.history(session, battery.id)
    ]


def _tests(session: Session, battery: Battery, rated_ah: float | None) -> list[LaboratoryMark]:
    if rated_ah is None:
        return []
    return [
        LaboratoryMark(
            test.at.timestamp(),
            test.capacity_ah / rated_ah,
            None if test.capacity_ah_sd is None else test.capacity_ah_sd / rated_ah,
            test.note,
        )
        for test in repository.all_tests(session, battery.id)
    ]
