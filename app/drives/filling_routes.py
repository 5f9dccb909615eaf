"""What a problem is made from over REST: a car's engine, and a whole problem filled in for it."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response

from app.answers import large_json
from app.drives.filling import engine_of, filled
from app.edge import OpenResources, ReadSession
from app.science.optimal.posing.car import CarKind

router = APIRouter(prefix="/drives", tags=["drives"])

CarId = Annotated[str, Query(pattern="^[0-9a-f]{32}$", description="The car.")]
Version = Annotated[str, Query(pattern="^(latest|[0-9]{1,9})$", description="Of its map: a number, or `latest`.")]
FitName = Annotated[
    Literal["willans", "phi"], Query(description="Fuel power that is convex in torque, or Table 4.1's terms.")
]


@router.get("/engines", response_model=dict[str, Any])
def show_engine(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    car_id: CarId,
    version: Version = "latest",
    fit: FitName = "willans",
) -> Response:
    """Give what a car's map becomes as the `engine` of a problem, and under `named` how a problem may name it."""
    return large_json(request, engine_of(session, opened.blobs, car_id, version, fit))


@router.get("/template", response_model=dict[str, Any])
def fill_in_problem(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    car_id: CarId,
    kind: CarKind = "accelerate",
    version: Version = "latest",
    fit: FitName = "willans",
    whole: Annotated[bool, Query(description="Write the engine out, for a file, instead of naming the map.")] = False,
) -> Response:
    """Give a problem for a car, filled in from its file and its map, with notes on what was decided."""
    return large_json(request, filled(session, opened.blobs, car_id, version, fit, kind, whole=whole))
