"""Scores over REST: of a trip with its figures, of a car, and the fleet's ranking."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import large_json
from app.eco import service, view
from app.eco.dashboard import dashboard
from app.eco.drawing import FigureName, Variant, draw
from app.eco.models import TripScoreRow
from app.eco.schemas import CarScore, RankBy, Ranked
from app.edge import OpenResources, ReadSession, WriteSession
from app.figures.numbers import rounded
from app.jobs.service import JobView
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

router = APIRouter(tags=["scores"])

DECIMALS = 4

ThemeName = Literal["light", "dark"]
Columns = Annotated[str, Query(max_length=1000, description="Names divided by commas; all without any.")]
By = Annotated[RankBy, Query(description="Rank cars, each by all its trips, or single trips.")]


def the_score(session: ReadSession, trip_id: Id) -> TripScoreRow:
    """Return the score of the address's trip."""
    return service.kept(session, trip_id)


TheScore = Annotated[TripScoreRow, Depends(the_score)]


@router.get("/trips/{trip_id}/score", response_model=dict[str, Any])
def show_score(request: Request, session: ReadSession, opened: OpenResources, trip_id: Id) -> Response:
    """Tell how much less the trip could have taken, where it was lost, and acceleration by acceleration; or why not."""
    return large_json(request, view.trip(session, opened.blobs, trip_id))


@router.get("/trips/{trip_id}/score/along", response_model=dict[str, list[float | None]])
def show_along(request: Request, opened: OpenResources, found: TheScore, columns: Columns = "") -> Response:
    """Give driven and best drive beside each other along the road, column by column."""
    names = [name.strip() for name in columns.split(",") if name.strip()]
    along = service.along(opened.blobs, found, names)
    return large_json(request, {name: rounded(values, DECIMALS) for name, values in along.items()})


@router.get("/trips/{trip_id}/dashboard", response_model=dict[str, Any])
def show_dashboard(request: Request, session: ReadSession, opened: OpenResources, trip_id: Id) -> Response:
    """Give what a display on the dashboard shows all along the trip: target speed, efficiency, worth of speed."""
    return large_json(request, dashboard(session, opened.blobs, trip_id))


@router.post("/trips/{trip_id}/score", status_code=202)
def score_trip(session: WriteSession, trip_id: Id) -> JobView:
    """Score the trip with its car's newest map."""
    return service.ask(session, trip_id)


@router.get("/trips/{trip_id}/figures/score-{name}", response_model=dict[str, Any])
def draw_score(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    found: TheScore,
    name: FigureName,
    variant: Variant = "map",
    theme: ThemeName = "light",
) -> Response:
    """Give a figure of the score as Plotly draws it."""
    return large_json(request, draw(session, opened, found, name, variant, theme))


@router.get("/cars/{car_id}/score")
def show_car_score(session: ReadSession, car_id: Id) -> CarScore:
    """Tell how near to its best drives the car is driven, trip by trip and all together."""
    return view.car(session, car_id)


@router.post("/cars/{car_id}/score", status_code=202)
def score_car(session: WriteSession, car_id: Id) -> Listing[JobView]:
    """Score those trips of the car that have no score, or one that rests on an older map than the newest."""
    return Listing[JobView](items=service.ask_for_car(session, car_id), next_cursor=None)


@router.get("/scores")
def rank(session: ReadSession, by: By = "car", cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT) -> Listing[Ranked]:
    """Rank the fleet's cars or trips, the best driven first; what has no score is not in it."""
    return view.ranking(session, by, cursor, limit)
