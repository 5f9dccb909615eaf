"""Cars and every version of their XML."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, Index, LargeBinary, String, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class Car(FleetOwned, Base):
    """A car of the fleet. Its XML stands in `CarConfigRevision`; ``revision`` is the number of the one in force.

    ``config_sha256`` is the XML's fingerprint, the same for files that differ in comments and blanks only. ``load_kg``
    is the driver and things, which the XML's mass leaves out.
    """

    __tablename__ = "cars"
    __table_args__ = (Index("ix_cars_newest", "fleet_id", "created_at", "id"),)

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200))
    title: Mapped[str] = mapped_column(String(300))
    revision: Mapped[int]
    config_sha256: Mapped[str] = mapped_column(String(64))
    load_kg: Mapped[float]
    created_at: Mapped[datetime] = mapped_column(default=now)
    updated_at: Mapped[datetime] = mapped_column(default=now)


class CarConfigRevision(FleetOwned, Base):
    """One version of a car's XML, counted from 1; never changed. ``note`` says where it came from, if not from hand."""

    __tablename__ = "car_config_revisions"
    __table_args__ = (UniqueConstraint("car_id", "number"),)

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    number: Mapped[int]
    sha256: Mapped[str] = mapped_column(String(64))
    xml: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    note: Mapped[str] = mapped_column(Text, default="", server_default="")
    created_at: Mapped[datetime] = mapped_column(default=now)
