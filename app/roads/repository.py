"""SQL of the elevation tables."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.roads.models import RoadElevationTable
from app.science.roads.elevation import Bounds
from app.storage.paging import Page, newest_first


def table(session: Session, table_id: str) -> RoadElevationTable | None:
    """Return a table."""
    return session.get(RoadElevationTable, table_id)


def tables(session: Session, cursor: str | None, limit: int) -> Page[RoadElevationTable]:
    """Return one page of the tables, newest first."""
    statement = select(RoadElevationTable)
    return newest_first(session, statement, RoadElevationTable.created_at, RoadElevationTable.id, cursor, limit)


def with_sha256(session: Session, sha256: str) -> RoadElevationTable | None:
    """Return the table of a content."""
    return session.scalars(select(RoadElevationTable).where(RoadElevationTable.sha256 == sha256)).first()


def overlapping(session: Session, bounds: Bounds) -> Sequence[RoadElevationTable]:
    """Return the tables whose area touches another, oldest first."""
    statement = select(RoadElevationTable).where(
        RoadElevationTable.south_deg <= bounds.north_deg,
        RoadElevationTable.north_deg >= bounds.south_deg,
        RoadElevationTable.west_deg <= bounds.east_deg,
        RoadElevationTable.east_deg >= bounds.west_deg,
    )
    return session.scalars(statement.order_by(RoadElevationTable.created_at, RoadElevationTable.id)).all()
