"""Table of the trips' scores: what is needed for rankings and lists; the whole score lies in the blobs."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier
from app.storage.tenancy import FleetOwned


class TripScoreRow(FleetOwned, Base):
    """The newest score of a trip, or why there is none.

    ``key`` names everything it depends on: the observer run, the car, the map and the code. ``reason`` says why the
    trip could not be scored; then the numbers are empty. ``document_key`` is where the whole score lies.

    ``fuel_l`` is what the scored sections took, ``saved_l`` what their best drives would not have taken of it, with
    its standard deviation; ``score`` is 100 where nothing was left to save.
    """

    __tablename__ = "trip_scores"
    __table_args__ = (Index("ix_trip_scores_best", "fleet_id", "score", "trip_id"),)

    trip_id: Mapped[Identifier] = mapped_column(ForeignKey("trips.id", ondelete="CASCADE"), primary_key=True)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    key: Mapped[str] = mapped_column(String(64))
    reason: Mapped[str] = mapped_column(Text, default="")
    score: Mapped[float | None]
    score_sd: Mapped[float | None]
    fuel_l: Mapped[float | None]
    saved_l: Mapped[float | None]
    saved_sd_l: Mapped[float | None]
    distance_m: Mapped[float | None]
    advice: Mapped[list[str]] = mapped_column(JSON, default=list)
    map_version: Mapped[int | None]
    document_key: Mapped[str | None] = mapped_column(String(300))
    provenance: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    code_version: Mapped[str] = mapped_column(String(64))
    scored_at: Mapped[datetime]
