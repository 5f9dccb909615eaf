"""Tables of the efficiency maps: what each trip adds, and the versions made from it."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, LargeBinary, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class TripCells(FleetOwned, Base):
    """Sums per cell of one trip's operating points, ready to be added to those of other trips.

    ``key`` is the observer run that the points came from; ``sums`` is packed by `app.maps.packing`.
    """

    __tablename__ = "trip_cells"

    trip_id: Mapped[Identifier] = mapped_column(ForeignKey("trips.id", ondelete="CASCADE"), primary_key=True)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    key: Mapped[str] = mapped_column(String(64))
    points: Mapped[int]
    torque_source: Mapped[str] = mapped_column(String(16))
    sums: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)


class MapVersion(FleetOwned, Base):
    """One immutable efficiency map of a car; its document lies in the blobs under ``document_key``.

    ``changes`` tells what is different from the version before; None where an earlier Ponthy made it.
    """

    __tablename__ = "map_versions"
    __table_args__ = (UniqueConstraint("car_id", "version"),)

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"))
    version: Mapped[int]
    key: Mapped[str] = mapped_column(String(64))
    cells: Mapped[int]
    trusted_cells: Mapped[int]
    points: Mapped[int]
    trips: Mapped[int]
    best: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    provenance: Mapped[dict[str, Any]] = mapped_column(JSON)
    changes: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    document_key: Mapped[str] = mapped_column(String(300))
    created_at: Mapped[datetime] = mapped_column(default=now)


class MapRules(FleetOwned, Base):
    """Which trips count in a car's map; a car without a row has the usual rules."""

    __tablename__ = "map_rules"

    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), primary_key=True)
    verdicts: Mapped[str] = mapped_column(String(16))
    smoothed_only: Mapped[bool]
    torque_source: Mapped[str] = mapped_column(String(16))
    since: Mapped[datetime | None]
    until: Mapped[datetime | None]


class MapReference(FleetOwned, Base):
    """A dynamometer's or a manufacturer's table to lay over a car's map; ``data`` is the file as it came."""

    __tablename__ = "map_references"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    name: Mapped[str] = mapped_column(String(200))
    fuel: Mapped[str] = mapped_column(String(16))
    filename: Mapped[str] = mapped_column(String(300))
    sha256: Mapped[str] = mapped_column(String(64))
    points: Mapped[int]
    data: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    created_at: Mapped[datetime] = mapped_column(default=now)
