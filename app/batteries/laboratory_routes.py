"""Capacity tests of batteries over REST."""

from __future__ import annotations

from fastapi import APIRouter

from app.batteries import testing
from app.batteries.schemas import CapacityTestView, NewCapacityTest
from app.edge import ReadSession, WriteSession
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

router = APIRouter(prefix="/batteries/{battery_id}/tests", tags=["batteries"])


@router.get("")
def list_tests(
    session: ReadSession, battery_id: Id, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[CapacityTestView]:
    """List a battery's capacity tests, the latest first."""
    return testing.page(session, battery_id, cursor, limit)


@router.post("", status_code=201)
def add_test(session: WriteSession, battery_id: Id, body: NewCapacityTest) -> CapacityTestView:
    """Keep a capacity that a laboratory measured; the ageing is compared with it."""
    return testing.add(session, battery_id, body)


@router.delete("/{test_id}", status_code=204)
def delete_test(session: WriteSession, battery_id: Id, test_id: Id) -> None:
    """Remove a capacity test."""
    testing.delete(session, battery_id, test_id)
