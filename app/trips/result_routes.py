"""Results of trips over REST: traces, figures, files, how the decoding went and how the sensors agree."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import attachment, large_json
from app.edge import OpenResources, ReadSession
from app.schemas import Id, Listing
from app.trips import service
from app.trips.drawing import FigureName, ThemeName, TripFigures, Wish
from app.trips.exporting import FORMATS, FormatName, export
from app.trips.models import Trip
from app.trips.schemas import Observability, SensorRow, Traces
from app.trips.stored import observability_of, report_of, torques_of
from app.trips.traces import at, traces

router = APIRouter(prefix="/trips/{trip_id}", tags=["trips"])

LONGEST_S = 1e9
Seconds = Annotated[float | None, Query(ge=-LONGEST_S, le=LONGEST_S, allow_inf_nan=False)]
Points = Annotated[int, Query(ge=8, le=100_000, description="Samples of a signal at most.")]
Signals = Annotated[str, Query(max_length=2000, description="Columns of states.parquet, separated by commas.")]


def the_trip(session: ReadSession, trip_id: Id) -> Trip:
    """Return the trip of the address."""
    return service.row(session, trip_id)


TheTrip = Annotated[Trip, Depends(the_trip)]


def wish(
    signals: Signals = "",
    from_s: Seconds = None,
    to_s: Seconds = None,
    points: Points = 4000,
    variant: Literal["map", "plan", ""] = "map",
) -> Wish:
    """Return what a request wants of a figure or of traces."""
    names = tuple(dict.fromkeys(name.strip() for name in signals.split(",") if name.strip()))
    return Wish(names, from_s, to_s, points, variant or "map")


TheWish = Annotated[Wish, Depends(wish)]


@router.get("/traces", response_model=Traces)
def show_traces(request: Request, opened: OpenResources, trip: TheTrip, wanted: TheWish) -> Response:
    """Give signals over time, decimated so that every spike is kept."""
    names = wanted.signals or ("speed_mps",)
    return large_json(request, traces(opened.blobs, trip, names, wanted.from_s, wanted.to_s, wanted.points))


@router.get("/at")
def show_moment(
    opened: OpenResources, trip: TheTrip, t_s: Annotated[float, Query(ge=-LONGEST_S, le=LONGEST_S, allow_inf_nan=False)]
) -> dict[str, float | None]:
    """Give all columns at the node nearest to a time."""
    return at(opened.blobs, trip, t_s)


@router.get("/figures/{name}", response_model=dict[str, Any])
def draw(
    request: Request,
    opened: OpenResources,
    trip: TheTrip,
    name: FigureName,
    wanted: TheWish,
    theme: ThemeName = "light",
) -> Response:
    """Give a figure as Plotly draws it."""
    return large_json(request, TripFigures(opened.blobs, opened.settings, trip, theme).draw(name, wanted))


@router.get("/export", response_class=Response)
def save(opened: OpenResources, trip: TheTrip, form: Annotated[FormatName, Query(alias="format")]) -> Response:
    """Give a trip as a file to save."""
    kind = FORMATS[form]
    return attachment(export(opened.blobs, trip, form), f"{trip.name}.{kind.ending}", kind.media_type)


@router.get("/decode-report")
def show_decode_report(request: Request, opened: OpenResources, trip: TheTrip) -> dict[str, Any]:
    """Tell what the uploaded file held: packets by type, gaps and repairs with their byte offsets, trips."""
    return report_of(opened.blobs, trip)


@router.get("/consistency")
def show_consistency(trip: TheTrip) -> Listing[SensorRow]:
    """Tell for each sensor how well it agrees with the filter's own uncertainty."""
    return Listing[SensorRow].model_validate({"items": trip.consistency, "next_cursor": None})


@router.get("/observability", response_model=Observability)
def show_observability(request: Request, opened: OpenResources, trip: TheTrip) -> Response:
    """Tell which states the trip's sensors tell, which would be lost with each of them, and what each minute adds."""
    return large_json(request, observability_of(opened.blobs, trip))


@router.get("/torque-sources", response_model=dict[str, Any])
def show_torque_sources(request: Request, opened: OpenResources, trip: TheTrip) -> Response:
    """Tell how the torque that the engine reports lies beside the car's motion, and what the difference is made of."""
    return large_json(request, torques_of(opened.blobs, trip))
