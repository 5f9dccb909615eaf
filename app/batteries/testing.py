"""Capacity tests of batteries in a laboratory: kept, listed, removed."""

from __future__ import annotations

from sqlalchemy.orm import Session

from app.batteries import repository, service
from app.batteries.models import BatteryTest
from app.batteries.schemas import CapacityTestView, NewCapacityTest
from app.errors import NotFound
from app.schemas import Listing


def add(session: Session, battery_id: str, wanted: NewCapacityTest) -> CapacityTestView:
    """Keep a test; raises `NotFound`."""
    row = BatteryTest(battery_id=service.row(session, battery_id).id, **wanted.model_dump())
    session.add(row)
    session.flush()
    return CapacityTestView.model_validate(row)


def page(session: Session, battery_id: str, cursor: str | None, limit: int) -> Listing[CapacityTestView]:
    """Return one page of a battery's tests, the latest first; raises `NotFound`."""
    found = repository.tests(session, service.row(session, battery_id).id, cursor, limit)
    return Listing[CapacityTestView].model_validate(found)


def delete(session: Session, battery_id: str, test_id: str) -> None:
    """Remove a test; raises `NotFound`."""
    found = repository.test(session, battery_id, test_id)
    if found is None:
        raise NotFound("capacity test", test_id)
    session.delete(found)
