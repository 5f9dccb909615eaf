"""Elevation tables over REST."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response

from app.edge import OpenResources, ReadSession, WriteSession
from app.roads import service
from app.roads.schemas import RoadDocument
from app.schemas import Cursor, Id, Limit, Listing, Name
from app.storage.paging import DEFAULT_LIMIT

router = APIRouter(prefix="/roads", tags=["roads"])

CSV_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "text/csv": {
                "schema": {"type": "string"},
                "example": "lat_deg,lon_deg,alt_m,way\n49.35,8.68,112.4,1\n49.3504,8.6801,112.9,1\n",
            }
        },
    }
}


async def csv_body(request: Request) -> bytes:
    """Return the table sent as the body."""
    return await request.body()


@router.get("")
def list_tables(session: ReadSession, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT) -> Listing[RoadDocument]:
    """List the fleet's elevation tables, newest first."""
    page = service.page(session, cursor, limit)
    return Listing[RoadDocument](items=[RoadDocument.of(row) for row in page.items], next_cursor=page.next_cursor)


@router.post("", status_code=201, openapi_extra=CSV_BODY)
def add_table(
    session: WriteSession,
    resources: OpenResources,
    response: Response,
    data: Annotated[bytes, Depends(csv_body)],
    name: Annotated[Name, Query(description="What to call it.")] = "elevation.csv",
) -> RoadDocument:
    """Keep a CSV of road nodes with the columns `lat_deg,lon_deg,alt_m` and optionally `way`.

    Neighbouring rows of one way are joined. Trips observed from now on use it wherever it covers them; the same bytes
    sent again are answered with the table that is there, and 200.
    """
    added = service.add_csv(session, resources.blobs, name=name, data=data)
    response.status_code = 201 if added.is_new else 200
    return RoadDocument.of(added.row)


@router.delete("/{table_id}", status_code=204)
def delete_table(table_id: Id, session: WriteSession, resources: OpenResources) -> None:
    """Remove an elevation table; results made with it stay."""
    service.delete(session, resources.blobs, table_id)
