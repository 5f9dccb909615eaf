"""Jobs of what is about to be changed or removed: locked first, so that locks are taken in one order everywhere."""

from __future__ import annotations

from sqlalchemy.orm import Session

from app.jobs import repository


def lock_of_battery(session: Session, battery_id: str) -> None:
    """Lock the jobs of a battery that is about to be removed, before the battery itself is locked."""
    repository.lock(session, battery_id=battery_id)


def lock_of_trip(session: Session, trip_id: str) -> None:
    """Lock the jobs of a trip that is about to be changed or removed, before the trip itself is locked."""
    repository.lock(session, trip_id=trip_id)


def lock_of_car(session: Session, car_id: str) -> None:
    """Lock the jobs of a car that is about to be removed, before its trips and the car itself are locked."""
    repository.lock(session, car_id=car_id)


def lock_of_drive(session: Session, drive_id: str) -> None:
    """Lock the jobs of a drive that is about to be removed, before the drive itself is locked."""
    repository.lock(session, drive_id=drive_id)


def forget_drive(session: Session, drive_id: str) -> None:
    """Remove the jobs of a drive that is about to be removed; a worker that has one finds its lease lost."""
    repository.delete_about(session, drive_id=drive_id)


def forget_battery(session: Session, battery_id: str) -> None:
    """Remove the jobs of a battery that is about to be removed; a worker that has one finds its lease lost."""
    repository.delete_about(session, battery_id=battery_id)
