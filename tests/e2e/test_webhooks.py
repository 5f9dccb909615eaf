"""A webhook in the browser: made, tested against a receiver that first refuses, looked at, sent again."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.webhooks.conftest import Receiver, listening, serving

Opener = Callable[..., Page]
FAULTS = (Path(__file__).parent / "accessibility.js").read_text()


@pytest.fixture
def refusing() -> Iterator[Receiver]:
    receiver = Receiver(answers=[(500, b"not yet")])
    with serving(listening(receiver)):
        yield receiver


def test_a_webhook_is_made_tested_and_told_again(open_page: Opener, refusing: Receiver) -> None:
    page = open_page("/settings")
    page.get_by_role("button", name="New webhook").click()
    page.get_by_label("Address (https)").fill(refusing.url)
    page.get_by_label("What it is for").fill("the workshop")
    page.get_by_label("a trip is ready").check()
    page.get_by_role("button", name="Make webhook").click()
    expect(page.locator("#webhook-secret code")).to_contain_text("whsec_")
    row, acts = page.locator("#webhooks tbody tr").first, page.locator("#webhooks tbody tr").last
    expect(row).to_contain_text("trip.ready, health.alert, health.cleared")
    expect(row).to_contain_text("active")
    acts.get_by_role("button", name="Send a test").click()
    tested = page.locator("#webhook-deliveries tbody tr", has_text="webhook.test")  # trips of other tests are told, too
    expect(tested).to_contain_text(re.compile(r"the receiver answered 500; again at \d+ \w+ 20\d\d"), timeout=60_000)
    expect(row).to_contain_text(re.compile(r"failing.*since \d+ \w+ 20\d\d"))
    tested.get_by_role("button", name="Deliver again").click()
    expect(tested).to_contain_text("delivered", timeout=60_000)
    expect(row).to_contain_text("active")
    assert page.evaluate(FAULTS) == []
    assert len(refusing.heard) >= 2  # it is tried again by itself, too, when the browser is slow
    assert {heard.headers["Ponthy-Event"] for heard in refusing.heard} <= {"webhook.test", "trip.ready"}
    acts.get_by_role("button", name="Remove").click()
    page.get_by_role("dialog").get_by_role("button", name="Remove").click()
    expect(page.locator("#webhooks")).to_contain_text("None yet.")
