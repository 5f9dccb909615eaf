"""A car's calibration over REST: looked at, and applied when asked."""

from __future__ import annotations

from fastapi import APIRouter

from app.cars import calibration as calibrations
from app.cars.calibration_schemas import (
    AppliedDocument,
    ApplyProposals,
    CalibrationDocument,
    ChangeDocument,
    ProposalDocument,
    RoadLoadDocument,
    TripSaysDocument,
)
from app.edge import OpenResources, ReadSession, WriteSession
from app.schemas import Id

router = APIRouter(prefix="/cars", tags=["cars"])


@router.get("/{car_id}/calibration")
def show_calibration(car_id: Id, session: ReadSession, opened: OpenResources) -> CalibrationDocument:
    """Tell what the trips observed with the car's file in force propose to change in it."""
    return _document(calibrations.calibration(session, opened.blobs, car_id))


@router.post("/{car_id}/calibration/apply", status_code=202)
def apply_calibration(
    car_id: Id, body: ApplyProposals, session: WriteSession, opened: OpenResources
) -> AppliedDocument:
    """Write proposals into the car's file as a new revision and run all its trips again."""
    applied = calibrations.apply(session, opened.blobs, car_id, body.names, body.key)
    return AppliedDocument.model_validate(applied)


def _document(found: calibrations.Calibration) -> CalibrationDocument:
    return CalibrationDocument(
        key=found.key,
        config_revision=found.config.revision,
        proposals=[
            ProposalDocument(
                name=one.name,
                title=calibrations.TITLES[one.name],
                changes=[ChangeDocument.model_validate(change) for change in one.changes],
                evidence=list(one.evidence),
                confidence=one.confidence,
                trips=one.trips,
                applicable=one.is_applicable,
            )
            for one in found.proposals
        ],
        road_load=None if found.road_load is None else RoadLoadDocument.model_validate(found.road_load),
        trips=[
            TripSaysDocument(
                trip_id=one.trip_id,
                name=one.name,
                started_at=one.started_at,
                refuelled_l=one.refuelled_l,
                counts=one.evidence is not None,
                why=one.why,
                missing={} if one.evidence is None else dict(one.evidence.missing),
            )
            for one in found.says
        ],
    )
