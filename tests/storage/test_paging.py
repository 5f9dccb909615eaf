"""Lists by cursor show every row once, newest first, also when times are equal and rows come in between."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import select

from app.accounts.models import DEFAULT_FLEET_ID
from app.cars.models import Car
from app.errors import Invalid
from app.storage.paging import decode_cursor, encode_cursor, newest_first
from app.storage.resources import Resources

START = datetime(2026, 3, 1, tzinfo=UTC)


def add(resources: Resources, number: int, minutes: int) -> None:
    with resources.database.transaction(DEFAULT_FLEET_ID) as session:
        created_at = START + timedelta(minutes=minutes)
        session.add(Car(name=str(number), title="", revision=1, config_sha256="", load_kg=0, created_at=created_at))


def pages(resources: Resources, limit: int, between: object = None) -> list[list[str]]:
    cursor, found = None, []
    while True:
        with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as session:
            page = newest_first(session, select(Car), Car.created_at, Car.id, cursor, limit)
            found.append([car.name for car in page.items])
        cursor = page.next_cursor
        if cursor is None:
            return found
        if callable(between):
            between()


def test_all_rows_come_once_newest_first(resources: Resources) -> None:
    for number in range(7):
        add(resources, number, minutes=number // 3)  # several at the same moment
    found = pages(resources, 2)
    flat = [int(name) for page in found for name in page]
    assert sorted(flat) == list(range(7))
    assert [number // 3 for number in flat] == sorted((number // 3 for number in range(7)), reverse=True)
    assert [len(page) for page in found] == [2, 2, 2, 1]


def test_the_last_full_page_ends_the_list(resources: Resources) -> None:
    for number in range(4):
        add(resources, number, minutes=number)
    assert pages(resources, 2) == [["3", "2"], ["1", "0"]]


def test_rows_that_come_meanwhile_do_not_disturb(resources: Resources) -> None:
    for number in range(4):
        add(resources, number, minutes=number)
    assert pages(resources, 2, lambda: add(resources, 99, minutes=60)) == [["3", "2"], ["1", "0"]]


@given(st.text(max_size=60))
def test_any_text_is_a_cursor_of_ours_or_refused(text: str) -> None:
    try:
        place = decode_cursor(text)
    except Invalid:
        return
    assert decode_cursor(encode_cursor(*place)) == place


@pytest.mark.parametrize("cursor", ["", "zzzz", "MjAyNi0wMy0wMQ", "4pi6"])
def test_what_is_no_cursor_is_refused(cursor: str) -> None:
    with pytest.raises(Invalid, match="not one that a list gave"):
        decode_cursor(cursor)
