"""Elevation tables of a fleet's roads."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class RoadElevationTable(FleetOwned, Base):
    """A table of road nodes with their altitude, kept as the CSV it came as, and the area it covers."""

    __tablename__ = "road_elevations"
    __table_args__ = (
        UniqueConstraint("fleet_id", "sha256"),
        Index("ix_road_elevations_newest", "fleet_id", "created_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(255))
    nodes: Mapped[int]
    south_deg: Mapped[float]
    west_deg: Mapped[float]
    north_deg: Mapped[float]
    east_deg: Mapped[float]
    sha256: Mapped[str] = mapped_column(String(64))
    blob_key: Mapped[str] = mapped_column(String(300))
    created_at: Mapped[datetime] = mapped_column(default=now)
