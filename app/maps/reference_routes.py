"""Dynamometers' and manufacturers' tables of a car over REST."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import attachment, large_json
from app.edge import OpenResources, ReadSession, WriteSession
from app.errors import PonthyError
from app.maps import referencing, service
from app.maps.reference_schemas import AgreementView, ApplyLevel, FuelName, LevelApplied, ReferenceView
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing, Name

router = APIRouter(prefix="/cars/{car_id}/references", tags=["maps"])

EXAMPLE = "rpm,nm,bsfc_gpkwh\n2000,40,310\n2000,80,268\n3000,40,318\n3000,80,270\n4000,40,331\n4000,80,279\n"
CSV_BODY: dict[str, Any] = {
    "requestBody": {"required": True, "content": {"text/csv": {"schema": {"type": "string"}, "example": EXAMPLE}}}
}


async def csv_body(request: Request) -> bytes:
    """Return the table sent as the body."""
    body = await request.body()
    if len(body) > referencing.LARGEST_BYTES:
        message = f"A table is {referencing.LARGEST_BYTES} bytes long at most; this one has {len(body)}."
        raise PonthyError("table-too-large", message, 413)
    return body


def the_table(
    session: ReadSession, opened: OpenResources, car_id: Id, reference_id: Id, version: str = "latest"
) -> referencing.Beside:
    """Return the table of the address beside a version of the car's map."""
    found = service.version(session, car_id, version)
    return referencing.beside(session, opened.blobs, car_id, reference_id, found)


TheTable = Annotated[referencing.Beside, Depends(the_table)]


@router.get("")
def list_references(
    session: ReadSession, car_id: Id, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[ReferenceView]:
    """List the tables laid over the car's maps, newest first."""
    return Listing[ReferenceView].model_validate(referencing.page(session, car_id, cursor, limit))


@router.post("", status_code=201, openapi_extra=CSV_BODY)
def add_reference(
    session: WriteSession,
    response: Response,
    car_id: Id,
    data: Annotated[bytes, Depends(csv_body)],
    name: Annotated[Name, Query(description="What to call it.")] = "Dynamometer",
    filename: Annotated[Name, Query(description="The file's name.")] = "table.csv",
    fuel: Annotated[FuelName | None, Query(description="Fuel it was measured with; left out, the car's.")] = None,
) -> ReferenceView:
    """Keep a CSV of engine speed (`rpm`), torque (`nm`) and `efficiency`, `fuel_gps` or `bsfc_gpkwh`.

    The same bytes sent again are answered with the table that is there, and 200.
    """
    row, is_new = referencing.add(session, car_id, name, filename, fuel, data)
    response.status_code = 201 if is_new else 200
    return ReferenceView.model_validate(row)


@router.get("/{reference_id}", response_class=Response)
def show_reference(session: ReadSession, car_id: Id, reference_id: Id) -> Response:
    """Give a table as it was sent."""
    row = referencing.get(session, car_id, reference_id)
    return attachment(row.data, row.filename, "text/csv")


@router.delete("/{reference_id}", status_code=204)
def delete_reference(session: WriteSession, car_id: Id, reference_id: Id) -> None:
    """Remove a table; maps and car file stay as they are."""
    referencing.delete(session, car_id, reference_id)


@router.get("/{reference_id}/agreement")
def show_agreement(session: ReadSession, found: TheTable) -> AgreementView:
    """Tell how a version of the car's map lies beside the table: scale, shape, peak, and what a correction would be."""
    return AgreementView.of(found, referencing.correction(session, found))


@router.get("/{reference_id}/figures/{name}", response_model=dict[str, Any])
def draw_reference(
    request: Request,
    found: TheTable,
    name: referencing.FigureName,
    quantity: Literal["efficiency", "bsfc"] = "efficiency",
    corrected: Annotated[bool, Query(description="Show the map with its level brought to the table's.")] = False,
    theme: Literal["light", "dark"] = "light",
) -> Response:
    """Give the map with the table's isolines over it, or the difference, as Plotly draws it."""
    return large_json(request, referencing.draw(found, name, quantity, corrected, theme))


@router.post("/{reference_id}/apply", status_code=202)
def apply_level(
    session: WriteSession, opened: OpenResources, car_id: Id, reference_id: Id, body: ApplyLevel
) -> LevelApplied:
    """Write the injectors' flow that brings the level to the table's as a new revision, and run all trips again."""
    version = service.version(session, car_id, str(body.version))
    found = referencing.beside(session, opened.blobs, car_id, reference_id, version)
    return LevelApplied.model_validate(referencing.apply(session, found, body.key))
