"""Elevation tables of a fleet: taken in, listed, removed, and found again where a trip went."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import partial

from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.imports.elevation import read_elevation
from app.roads import repository
from app.roads.models import RoadElevationTable
from app.science.roads.elevation import Bounds, RoadElevation, join_tables
from app.storage.base import new_id
from app.storage.blobs import Blobs
from app.storage.database import afterwards
from app.storage.paging import DEFAULT_LIMIT, Page
from app.storage.tenancy import fleet_of

__all__ = ["Added", "Bounds", "Elevation", "Table", "add_csv", "add_table", "delete", "elevation_for", "page"]


@dataclass(frozen=True, slots=True)
class Table:
    """An elevation table as it was read: its roads and the fingerprint of its bytes."""

    roads: RoadElevation
    sha256: str


@dataclass(frozen=True, slots=True)
class Added:
    """What became of a table: its row, and whether it is new to the fleet."""

    row: RoadElevationTable
    is_new: bool


@dataclass(frozen=True, slots=True)
class Elevation:
    """What a fleet knows of altitudes in an area: the roads, None where it knows nothing, and from which tables."""

    roads: RoadElevation | None
    sha256s: tuple[str, ...]


def read_table(data: bytes) -> Table:
    """Read a CSV of road nodes; raises `SignalsError` with row and field."""
    return Table(read_elevation(data), hashlib.sha256(data).hexdigest())


def add_table(session: Session, table: Table, *, name: str, blob_key: str) -> Added:
    """Keep a table whose bytes lie under a key already; the same bytes are kept once."""
    bounds = table.roads.bounds
    row = RoadElevationTable(
        name=name,
        nodes=table.roads.node_count,
        south_deg=bounds.south_deg,
        west_deg=bounds.west_deg,
        north_deg=bounds.north_deg,
        east_deg=bounds.east_deg,
        sha256=table.sha256,
        blob_key=blob_key,
    )
    try:
        with session.begin_nested():
            session.add(row)
    except IntegrityError:
        known = repository.with_sha256(session, table.sha256)
        if known is None:
            raise
        return Added(known, is_new=False)
    return Added(row, is_new=True)


def add_csv(session: Session, blobs: Blobs, *, name: str, data: bytes) -> Added:
    """Read and keep a table; raises `SignalsError` with row and field."""
    table = read_table(data)
    key = f"fleets/{fleet_of(session)}/roads/{new_id()}.csv"
    blobs.put(key, data)
    added = add_table(session, table, name=name, blob_key=key)
    if not added.is_new:
        blobs.delete(key)
    return added


def page(session: Session, cursor: str | None = None, limit: int = DEFAULT_LIMIT) -> Page[RoadElevationTable]:
    """Return one page of the fleet's tables, newest first."""
    return repository.tables(session, cursor, limit)


def delete(session: Session, blobs: Blobs, table_id: str) -> None:
    """Remove a table; results made with it stay. Raises `NotFound`."""
    row = repository.table(session, table_id)
    if row is None:
        raise NotFound("elevation table", table_id)
    session.delete(row)
    afterwards(session, partial(blobs.delete, row.blob_key))


def elevation_for(session: Session, blobs: Blobs, bounds: Bounds | None) -> Elevation:
    """Return all roads of the fleet with known altitude that may lie in an area.

    Parameters
    ----------
    session : Session
    blobs : Blobs
    bounds : Bounds or None
        Where the trip went; None when nobody knows.

    Returns
    -------
    Elevation
        Whole tables, joined; a table counts when its rectangle touches the area's.
    """
    rows = [] if bounds is None else repository.overlapping(session, bounds)
    if not rows:
        return Elevation(None, ())
    roads = join_tables(read_elevation(blobs.get(row.blob_key)) for row in rows)
    return Elevation(roads, tuple(row.sha256 for row in rows))
