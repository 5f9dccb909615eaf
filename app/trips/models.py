"""Table of the trips: what was driven, from which bytes it comes, and the newest result of the observer."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, BigInteger, ForeignKey, Index, String, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned

LEFT_OUT = (
    "The observer failed, so this trip was left out of the car's map until it does better; take it in by hand if you "
    "trust it."
)


class Trip(FleetOwned, Base):
    """One trip: a segment of an upload, counted from 0. ``input_key`` is where the uploaded bytes lie.

    ``decode_key`` and ``observe_key`` name the finished work of a stage: a hash over its input, its configuration
    and the code. Stored results lie under these names, so a new run never touches what an older one left.

    ``refuelled_l`` is what filled the tank up right after the trip, as the pump counted it.
    """

    __tablename__ = "trips"
    __table_args__ = (
        UniqueConstraint("upload_id", "segment"),
        Index("ix_trips_newest", "fleet_id", "created_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    upload_id: Mapped[Identifier] = mapped_column(ForeignKey("uploads.id", ondelete="CASCADE"), index=True)
    segment: Mapped[int] = mapped_column(default=0)
    input_key: Mapped[str] = mapped_column(String(300))
    input_sha256: Mapped[str] = mapped_column(String(64))
    input_bytes: Mapped[int] = mapped_column(BigInteger)
    mapping: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    name: Mapped[str] = mapped_column(String(200))
    filename: Mapped[str] = mapped_column(String(300))
    notes: Mapped[str] = mapped_column(Text, default="")
    in_map: Mapped[bool] = mapped_column(default=True)
    options: Mapped[dict[str, Any]] = mapped_column(JSON)
    decode_key: Mapped[str | None] = mapped_column(String(64))
    observe_key: Mapped[str | None] = mapped_column(String(64))
    started_at: Mapped[datetime | None]
    duration_s: Mapped[float | None]
    distance_m: Mapped[float | None]
    fuel_l: Mapped[float | None]
    fuel_energy_j: Mapped[float | None]
    refuelled_l: Mapped[float | None]
    verdict: Mapped[str | None] = mapped_column(String(16))
    reasons: Mapped[list[str]] = mapped_column(JSON, default=list)
    warnings: Mapped[list[str]] = mapped_column(JSON, default=list)
    consistency: Mapped[list[dict[str, Any]]] = mapped_column(JSON, default=list)
    filter: Mapped[str | None] = mapped_column(String(16))
    tuning: Mapped[str | None] = mapped_column(String(200))
    smoothed: Mapped[bool | None]
    code_version: Mapped[str | None] = mapped_column(String(64))
    provenance: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    summary: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    created_at: Mapped[datetime] = mapped_column(default=now)

    @property
    def is_left_out_by_itself(self) -> bool:
        """Whether it is not in the map because the observer failed, not because somebody said so."""
        return not self.in_map and LEFT_OUT in self.warnings
