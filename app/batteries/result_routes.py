"""What was estimated of batteries over REST: history, whole answers, figures, ageing, files."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import attachment, large_json
from app.batteries import service
from app.batteries.ageing import ageing_document
from app.batteries.drawing import Threshold, Wish, draw
from app.batteries.models import Battery
from app.batteries.results import FORMATS, FormatName, answer_of, export_answer, export_history
from app.batteries.schemas import EstimateView
from app.edge import OpenResources, ReadSession
from app.figures.battery import BatteryFigure
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

router = APIRouter(prefix="/batteries/{battery_id}", tags=["batteries"])

Form = Annotated[FormatName, Query(alias="format")]


def the_battery(session: ReadSession, battery_id: Id) -> Battery:
    """Return the battery of the address."""
    return service.row(session, battery_id)


TheBattery = Annotated[Battery, Depends(the_battery)]


@router.get("/estimates")
def list_estimates(
    session: ReadSession,
    battery_id: Id,
    trip_id: Annotated[str | None, Query(max_length=32)] = None,
    cursor: Cursor = None,
    limit: Limit = DEFAULT_LIMIT,
) -> Listing[EstimateView]:
    """List what trips and files say of a battery, the latest first; those that say nothing tell why."""
    return service.estimates(session, battery_id, trip_id=trip_id, cursor=cursor, limit=limit)


@router.get("/estimates/{estimate_id}", response_model=dict[str, Any])
def show_estimate(
    request: Request, session: ReadSession, opened: OpenResources, battery_id: Id, estimate_id: Id
) -> Response:
    """Give a whole answer as `./ponthy battery --json` does, with where it came from."""
    return large_json(request, answer_of(opened.blobs, service.estimate(session, battery_id, estimate_id)))


@router.get("/estimates/{estimate_id}/export", response_class=Response)
def save_estimate(
    session: ReadSession, opened: OpenResources, battery_id: Id, estimate_id: Id, form: Form = "json"
) -> Response:
    """Give a whole answer as a file: everything as json, or what it says over time as a table."""
    found = service.estimate(session, battery_id, estimate_id)
    data = export_answer(answer_of(opened.blobs, found), form)
    return attachment(data, f"{found.source}.battery{FORMATS[form].ending}", FORMATS[form].media_type)


@router.get("/figures/{name}", response_model=dict[str, Any])
def draw_battery(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    found: TheBattery,
    name: BatteryFigure,
    wish: Annotated[Wish, Depends()],
) -> Response:
    """Give a figure of a battery as Plotly draws it, of its latest estimate or of a given one."""
    return large_json(request, draw(session, opened.blobs, found, name, wish))


@router.get("/ageing", response_model=dict[str, Any])
def show_ageing(
    request: Request,
    session: ReadSession,
    found: TheBattery,
    threshold: Threshold = None,
    use_tests: Annotated[bool, Query(description="Let laboratory tests take part in the trend.")] = False,
) -> Response:
    """Give trends of capacity and resistance with bands, the remaining life, and how laboratory tests compare."""
    return large_json(request, ageing_document(session, found, threshold, use_tests=use_tests))


@router.get("/export", response_class=Response)
def save_history(session: ReadSession, found: TheBattery, form: Form = "json") -> Response:
    """Give a battery's history as a file, one row for each trip and file that told something."""
    data = export_history(session, found, form)
    return attachment(data, f"{found.name}{FORMATS[form].ending}", FORMATS[form].media_type)
