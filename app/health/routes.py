"""The cars' health over REST: how a car is, its trends, what was told about it, and what its usual is."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.accounts import service as accounts
from app.answers import large_json
from app.cars import service as cars
from app.edge import CurrentPrincipal, ReadSession, WriteSession
from app.health import service, view
from app.health.drawing import FigureName, draw
from app.health.schemas import AlertDocument, HealthDocument, NewUsual, UsualDocument
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

router = APIRouter(tags=["health"])

ThemeName = Literal["light", "dark"]
CarFilter = Annotated[str | None, Query(pattern="^[0-9a-f]{32}$", description="Of this car only.")]
StateFilter = Annotated[
    service.StateWanted, Query(description="`current` are those that are not over: open and seen ones.")
]


def the_car(session: ReadSession, car_id: Id) -> str:
    """Return the identifier of the car of the address, which is there."""
    return cars.get(session, car_id).id


@router.get("/cars/{car_id}/health")
def show_health(session: ReadSession, car_id: Id) -> HealthDocument:
    """Say how a car is: alerts in words, each quantity's trend beside its usual, and which trips this rests on."""
    return view.health(session, car_id)


@router.get("/cars/{car_id}/health/figures/{name}", response_model=dict[str, Any])
def draw_trend(
    request: Request,
    session: ReadSession,
    car_id: Annotated[str, Depends(the_car)],
    name: FigureName,
    theme: ThemeName = "light",
) -> Response:
    """Give a quantity's trend with its bands and change points, or what idling burnt, as Plotly draws it."""
    return large_json(request, draw(session, car_id, name, theme))


@router.post("/cars/{car_id}/health/usual", status_code=202)
def set_usual(session: WriteSession, car_id: Id, body: NewUsual) -> UsualDocument:
    """Take how the car is since a trip or a moment as its usual; its open alerts are over by that."""
    since, job = service.set_usual(session, car_id, body)
    return UsualDocument(usual_since=since, job_id=job.id)


@router.delete("/cars/{car_id}/health/usual", status_code=202)
def forget_usual(session: WriteSession, car_id: Id) -> UsualDocument:
    """Let the car's first trips say again what is usual."""
    return UsualDocument(usual_since=None, job_id=service.forget_usual(session, car_id).id)


@router.post("/cars/{car_id}/health/alerts/{alert_id}/seen")
def see_alert(session: WriteSession, who: CurrentPrincipal, car_id: Id, alert_id: Id) -> AlertDocument:
    """Note that an alert was seen; it stays until it is over."""
    user = accounts.signed_in_user(session, who.user_id)
    return service.see(session, car_id, alert_id, None if user is None else user.email)


@router.get("/alerts")
def list_alerts(
    session: ReadSession,
    state: StateFilter = "current",
    car_id: CarFilter = None,
    cursor: Cursor = None,
    limit: Limit = DEFAULT_LIMIT,
) -> Listing[AlertDocument]:
    """List alerts of all cars, newest first."""
    return service.alerts(session, state=state, car_id=car_id, cursor=cursor, limit=limit)
