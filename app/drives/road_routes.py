"""Roads for problems over REST."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response
from pydantic import BeforeValidator, TypeAdapter
from starlette.concurrency import run_in_threadpool

from app.answers import large_json
from app.bodies import short_body, validated
from app.drives.roads import road_as_asked, road_of_file
from app.drives.schemas import RoadAsked, road_alone
from app.edge import CurrentPrincipal, OpenResources
from app.imports.road import RoadWishes
from app.science.optimal.posing.cleaning import Cleaning
from app.storage.resources import Resources

LARGEST_FILE_BYTES = 20_000_000
ASKED: TypeAdapter[RoadAsked] = TypeAdapter(Annotated[RoadAsked, BeforeValidator(road_alone)])
FILE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/octet-stream": {"schema": {"type": "string", "format": "binary"}},
            "application/json": {"schema": ASKED.json_schema()},
        },
    }
}
SLOWEST_MPS, FASTEST_MPS = 0.1, 150.0

router = APIRouter(prefix="/drives/roads", tags=["drives"])


def asked_for(
    speed_limit_mps: Annotated[
        float | None, Query(ge=SLOWEST_MPS, le=FASTEST_MPS, description="Where the file says none; 50 km/h if unset.")
    ] = None,
    level: Annotated[bool, Query(description="Leave heights out.")] = False,
    smooth_m: Annotated[
        float | None, Query(ge=0, le=5000, description="Smoothing of heights; unset: as usual.")
    ] = None,
    tolerance_m: Annotated[float, Query(ge=0, le=50, description="Heights may be off by that much.")] = 0.25,
    longest_gap_m: Annotated[float, Query(ge=1, le=1e6, description="Longest way without a point.")] = 2000.0,
) -> RoadWishes:
    """Return how a file is to be taken."""
    cleaning = Cleaning(tolerance_m=tolerance_m, longest_gap_m=longest_gap_m)
    return RoadWishes(speed_limit_mps, None, level, smooth_m, cleaning)


@router.post("", response_model=dict[str, Any], openapi_extra=FILE)
async def read_road(
    request: Request,
    who: CurrentPrincipal,
    opened: OpenResources,
    wishes: Annotated[RoadWishes, Depends(asked_for)],
    part: Annotated[int | None, Query(ge=1, le=100_000, description="Of a cycle with stops; else the longest.")] = None,
) -> Response:
    """Give the `road` in a GPX track, a table or a driving cycle, sent as the body, or a trip's; nothing is kept."""
    data = await short_body(request, LARGEST_FILE_BYTES, "road-file-too-large", "A file with a road")
    if data.lstrip().startswith(b"{"):
        found = await run_in_threadpool(_known, opened, who.fleet_id, validated(ASKED, data), wishes)
    else:
        found = await run_in_threadpool(road_of_file, data, wishes, part)
    return large_json(request, found)


def _known(opened: Resources, fleet_id: str, asked: RoadAsked, wishes: RoadWishes) -> dict[str, Any]:
    with opened.database.transaction(fleet_id, read_only=True) as session:
        return road_as_asked(session, opened.blobs, asked, wishes)
