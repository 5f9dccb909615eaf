"""Cars over REST."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from pydantic import TypeAdapter

from app.bodies import short_body, validated
from app.cars import schemas, service, view
from app.edge import OpenResources, ReadSession, WriteSession
from app.errors import Conflict, PonthyError
from app.jobs.service import JobView
from app.maps import service as maps
from app.schemas import Cursor, Id, Limit, Listing
from app.storage.paging import DEFAULT_LIMIT
from app.trips import service as trips
from app.uploads import service as uploads

XML = "application/xml"
LARGEST_XML_BYTES = 1_000_000

router = APIRouter(prefix="/cars", tags=["cars"])

XML_SCHEMA = {"schema": {"type": "string"}, "example": '<ponthy_config><mass wet="844kg"/></ponthy_config>'}
XML_BODY = {"requestBody": {"required": True, "content": {XML: XML_SCHEMA}}}
CAR_BODY: dict[str, Any] = {
    "requestBody": {
        "content": {"application/json": {"schema": schemas.NewCar.model_json_schema()}, XML: XML_SCHEMA},
    }
}
XML_ANSWER: dict[int | str, dict[str, Any]] = {200: {"content": {XML: XML_SCHEMA}, "description": "The XML."}}


async def xml_body(request: Request) -> bytes:
    """Return the XML sent as the body, whatever its media type claims to be."""
    return await short_body(request, LARGEST_XML_BYTES, "car-xml-too-large", "A car's XML")


async def new_car(request: Request) -> schemas.NewCar | bytes:
    """Return what a new car is made from: JSON, or its XML itself."""
    body = await xml_body(request)
    kind = request.headers.get("content-type", "application/json").partition(";")[0].strip().lower()
    if kind in (XML, "text/xml"):
        return body
    if kind != "application/json":
        message = f"A car is made from application/json or {XML}, not from {kind!r}."
        raise PonthyError("unsupported-media-type", message, 415)
    return validated(TypeAdapter(schemas.NewCar), body or b"{}")


@router.get("")
def list_cars(
    session: ReadSession, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[schemas.CarDocument]:
    """List the fleet's cars, newest first."""
    page = service.page(session, cursor, limit)
    return Listing[schemas.CarDocument](items=view.cars(session, page.items), next_cursor=page.next_cursor)


@router.post("", status_code=201, openapi_extra=CAR_BODY)
def create_car(
    body: Annotated[schemas.NewCar | bytes, Depends(new_car)], session: WriteSession, response: Response
) -> schemas.CarDocument:
    """Make a car from its XML, or an empty one to be filled in."""
    if isinstance(body, bytes):
        car = service.create(session, xml=body)
    else:
        xml = None if body.config_xml is None else body.config_xml.encode()
        car = service.create(session, xml=xml, name=body.name)
    response.headers["Location"] = f"/api/v1/cars/{car.id}"
    return view.car(session, car)


@router.get("/{car_id}")
def show_car(car_id: Id, session: ReadSession) -> schemas.CarDocument:
    """Show a car, what its trips add up to, and its newest map in short."""
    return view.car(session, service.get(session, car_id))


@router.patch("/{car_id}")
def change_car(car_id: Id, body: schemas.CarChange, session: WriteSession) -> schemas.CarDocument:
    """Rename a car, or say what load it carries besides its own mass."""
    return view.car(session, service.change(session, car_id, name=body.name, load_kg=body.load_kg))


@router.delete("/{car_id}", status_code=204)
def delete_car(
    car_id: Id, session: WriteSession, resources: OpenResources, with_trips: Annotated[bool, Query()] = False
) -> None:
    """Remove a car; while it has trips only with `with_trips=true`, which removes them too."""
    service.get(session, car_id)
    count = trips.totals_of_cars(session, [car_id])[car_id].trip_count
    if count and not with_trips:
        message = f"Trips were driven with this car: {count}. Remove them first, or all at once with with_trips=true."
        raise Conflict("car-has-trips", message)
    trips.delete_of_car(session, car_id)
    maps.delete_of_car(session, car_id)
    uploads.forget_of_car(session, resources, car_id)
    service.delete(session, car_id)


@router.get("/{car_id}/config", response_class=Response, responses=XML_ANSWER)
def show_config(car_id: Id, session: ReadSession, revision: Annotated[int | None, Query(ge=1)] = None) -> Response:
    """Give the car's XML: the one in force, or an older revision."""
    xml = service.config_xml(session, car_id, revision)
    return Response(xml, media_type=XML, headers={"Content-Disposition": 'attachment; filename="car.xml"'})


@router.put("/{car_id}/config", openapi_extra=XML_BODY)
def replace_config(car_id: Id, session: WriteSession, xml: Annotated[bytes, Depends(xml_body)]) -> schemas.CarDocument:
    """Put a new XML in force; the old one stays among the revisions. Trips keep their results until reprocessed."""
    return view.car(session, service.replace_config(session, car_id, xml))


@router.get("/{car_id}/config/form")
def show_form(car_id: Id, session: ReadSession) -> schemas.FormDocument:
    """Give the fields of the car's form with the values of its XML."""
    return view.form(session, car_id)


@router.put("/{car_id}/config/form")
def fill_form(car_id: Id, body: schemas.FormValues, session: WriteSession) -> schemas.FormDocument:
    """Write values into the car's XML; everything else in it stays as it is."""
    service.fill_form(session, car_id, body.values)
    return view.form(session, car_id)


@router.get("/{car_id}/config/revisions")
def list_revisions(
    car_id: Id, session: ReadSession, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[schemas.RevisionDocument]:
    """List all versions of the car's XML, newest first."""
    return Listing[schemas.RevisionDocument].model_validate(service.revisions(session, car_id, cursor, limit))


@router.post("/{car_id}/config/revisions/{number}/restore")
def restore_config(
    car_id: Id, number: Annotated[int, Path(ge=1, le=1_000_000)], session: WriteSession
) -> schemas.CarDocument:
    """Put an older XML in force again, as a new revision. Trips keep their results until reprocessed."""
    return view.car(session, service.restore_config(session, car_id, number))


@router.post("/{car_id}/reprocess", status_code=202)
def reprocess_car(car_id: Id, session: WriteSession) -> Listing[JobView]:
    """Run all trips of the car again with its XML and the program as they are now."""
    service.get(session, car_id)
    return Listing[JobView](items=trips.reprocess_car(session, car_id), next_cursor=None)
