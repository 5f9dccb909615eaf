"""Tables of the batteries: what belongs to which car, what was estimated when and from what, laboratory tests."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import JSON, BigInteger, ForeignKey, Index, String, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class Work(StrEnum):
    """What jobs do about batteries, by the names of their stages."""

    ESTIMATE = "estimate"
    REESTIMATE = "reestimate"
    CURVE = "curve"
    REPORT = "report"


class Battery(FleetOwned, Base):
    """The battery of a car; ``config_revision`` is where in the car's XML, which says what it is, it was seen last."""

    __tablename__ = "batteries"
    __table_args__ = (UniqueConstraint("car_id"), Index("ix_batteries_newest", "fleet_id", "created_at", "id"))

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"))
    name: Mapped[str] = mapped_column(String(200))
    config_revision: Mapped[int]
    created_at: Mapped[datetime] = mapped_column(default=now)


class BatteryFile(FleetOwned, Base):
    """A file of measurements as it was sent; ``began_at`` is when its time is zero, where the sender said so.

    The same bytes for the same work are kept once.
    """

    __tablename__ = "battery_files"
    __table_args__ = (UniqueConstraint("battery_id", "work", "sha256"),)

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    battery_id: Mapped[Identifier] = mapped_column(ForeignKey("batteries.id", ondelete="CASCADE"))
    work: Mapped[str] = mapped_column(String(16))
    name: Mapped[str] = mapped_column(String(300))
    sha256: Mapped[str] = mapped_column(String(64))
    size: Mapped[int] = mapped_column(BigInteger)
    blob_key: Mapped[str] = mapped_column(String(300))
    began_at: Mapped[datetime | None]
    created_at: Mapped[datetime] = mapped_column(default=now)


class BatteryEstimate(FleetOwned, Base):
    """What one trip or one file says of a battery, or why it says nothing; the whole answer lies in the blobs.

    ``key`` names everything that it depends on: the measurements, the configuration, what was carried over, the code.
    ``follows_id`` is the earlier estimate that it began with; the numbers are named as the contract names them.
    ``charge_ah`` is what went through the battery, in and out, in all.
    """

    __tablename__ = "battery_estimates"
    __table_args__ = (
        UniqueConstraint("battery_id", "trip_id"),
        UniqueConstraint("battery_id", "file_id"),
        Index("ix_battery_estimates_history", "battery_id", "began_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    battery_id: Mapped[Identifier] = mapped_column(ForeignKey("batteries.id", ondelete="CASCADE"))
    trip_id: Mapped[Identifier | None] = mapped_column(ForeignKey("trips.id", ondelete="CASCADE"), index=True)
    file_id: Mapped[Identifier | None] = mapped_column(ForeignKey("battery_files.id", ondelete="CASCADE"), index=True)
    source: Mapped[str] = mapped_column(String(300))
    began_at: Mapped[datetime]
    ended_at: Mapped[datetime]
    key: Mapped[str] = mapped_column(String(64))
    reason: Mapped[str] = mapped_column(Text, default="")
    estimator: Mapped[str] = mapped_column(String(16), default="")
    capacity_ah: Mapped[float | None]
    capacity_ah_sd: Mapped[float | None]
    resistance_ohm: Mapped[float | None]
    resistance_ohm_sd: Mapped[float | None]
    relaxation_capacitance_f: Mapped[float | None]
    relaxation_capacitance_f_sd: Mapped[float | None]
    relaxation_resistance_ohm: Mapped[float | None]
    relaxation_resistance_ohm_sd: Mapped[float | None]
    soc: Mapped[float | None]
    soc_sd: Mapped[float | None]
    soh: Mapped[float | None]
    soh_sd: Mapped[float | None]
    current_bias_a: Mapped[float | None]
    current_bias_a_sd: Mapped[float | None]
    voltage_rms_v: Mapped[float | None]
    voltage_noise_v: Mapped[float | None]
    charge_ah: Mapped[float | None]
    follows_id: Mapped[str | None] = mapped_column(String(32))
    carry: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    document_key: Mapped[str | None] = mapped_column(String(300))
    warnings: Mapped[list[str]] = mapped_column(JSON, default=list)
    provenance: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    code_version: Mapped[str] = mapped_column(String(64))
    made_at: Mapped[datetime] = mapped_column(default=now)


class BatteryTest(FleetOwned, Base):
    """A capacity that a laboratory measured, of the whole battery as the configuration counts it: per cell."""

    __tablename__ = "battery_tests"
    __table_args__ = (Index("ix_battery_tests_battery_id_at", "battery_id", "at"),)

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    battery_id: Mapped[Identifier] = mapped_column(ForeignKey("batteries.id", ondelete="CASCADE"))
    at: Mapped[datetime]
    capacity_ah: Mapped[float]
    capacity_ah_sd: Mapped[float | None]
    note: Mapped[str] = mapped_column(Text, default="")
    created_at: Mapped[datetime] = mapped_column(default=now)


class BatteryRun(FleetOwned, Base):
    """One piece of work done by one job; what it found lies in the blobs under ``document_key``, where it is a file.

    The report's runs are about no battery.
    """

    __tablename__ = "battery_runs"
    __table_args__ = (Index("ix_battery_runs_battery_id_work", "battery_id", "work"),)

    job_id: Mapped[Identifier] = mapped_column(ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    battery_id: Mapped[Identifier | None] = mapped_column(ForeignKey("batteries.id", ondelete="CASCADE"))
    file_id: Mapped[Identifier | None] = mapped_column(ForeignKey("battery_files.id", ondelete="CASCADE"), index=True)
    work: Mapped[str] = mapped_column(String(16))
    options: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    document_key: Mapped[str | None] = mapped_column(String(300))
    provenance: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    created_at: Mapped[datetime] = mapped_column(default=now)
