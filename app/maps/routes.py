"""The maps of a car over REST: versions, documents, figures, files."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import attachment, large_json
from app.cars import service as cars
from app.edge import OpenResources, ReadSession
from app.maps import comparing_routes, reference_routes, rules_routes, service
from app.maps.drawing import FigureName, draw
from app.maps.exporting import MEDIA_TYPES, FormatName, export
from app.maps.models import MapVersion
from app.maps.schemas import MapView
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

maps = APIRouter(prefix="/cars/{car_id}/maps", tags=["maps"])
router = APIRouter()

ThemeName = Literal["light", "dark"]
QuantityName = Annotated[Literal["efficiency", "bsfc"], Query(description="Efficiency, or fuel consumption in g/kWh.")]


def the_map(session: ReadSession, car_id: Id, version: str) -> MapVersion:
    """Return the map of the address; its version is a number, or `latest`."""
    return service.version(session, car_id, version)


TheMap = Annotated[MapVersion, Depends(the_map)]


@maps.get("")
def list_maps(
    session: ReadSession, car_id: Id, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[MapView]:
    """List the versions of the car's efficiency map, newest first."""
    return service.page(session, car_id, cursor=cursor, limit=limit)


@maps.get("/{version}", response_model=dict[str, Any])
def show_map(request: Request, opened: OpenResources, found: TheMap) -> Response:
    """Give a version of the map, cell by cell, with what it was made from; `latest` is the newest."""
    about = MapView.model_validate(found).model_dump(mode="json", exclude={"cells", "provenance", "best"})
    return large_json(request, service.document(opened.blobs, found) | about)


@maps.get("/{version}/figures/{name}", response_model=dict[str, Any])
def draw_map(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    found: TheMap,
    name: FigureName,
    quantity: QuantityName = "efficiency",
    theme: ThemeName = "light",
) -> Response:
    """Give a figure as Plotly draws it: contours, a surface, or how many points each cell has."""
    return large_json(request, draw(session, opened.blobs, found, name, quantity, theme))


@maps.get("/{version}/export", response_class=Response)
def save_map(
    session: ReadSession, opened: OpenResources, found: TheMap, form: Annotated[FormatName, Query(alias="format")]
) -> Response:
    """Give a map as a file to save."""
    title = f"{cars.get(session, found.car_id).name}, map {found.version}"
    return attachment(export(opened.blobs, found, form, title), f"{title}.{form}", MEDIA_TYPES[form])


before = (reference_routes.router, comparing_routes.router, rules_routes.router)
for part in (*before, maps):  # a version may have any name, so it is asked for last
    router.include_router(part)
