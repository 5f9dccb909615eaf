"""A Ponthy that asks who is there: every page leads to the login and back."""

from __future__ import annotations

from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.support import PASSWORD, PERSON, Watch

pytestmark = pytest.mark.e2e


@pytest.fixture
def stranger(browser: Browser, guarded_ponthy: str) -> Iterator[Page]:
    """A page of somebody who has not logged in; being refused until then is all that may go wrong."""
    watch = Watch(urlsplit(guarded_ponthy).netloc)
    watch.expect(r"40[13]")
    context = browser.new_context(base_url=guarded_ponthy)
    watch.on(context)
    yield context.new_page()
    context.close()
    assert watch.unexpected() == []


def _log_in(page: Page, password: str) -> None:
    page.get_by_label("E-mail").fill(PERSON)
    page.get_by_label("Password").fill(password)
    page.keyboard.press("Enter")


def test_a_stranger_is_led_to_the_login_and_then_on(stranger: Page) -> None:
    stranger.goto("/settings")
    stranger.wait_for_url("**/login?next=%2Fsettings")
    _log_in(stranger, PASSWORD)
    stranger.wait_for_url("**/settings")
    expect(stranger.locator("#session")).to_contain_text(PERSON)
    stranger.get_by_role("button", name="Sign out").click()
    stranger.wait_for_url("**/login")


def test_a_wrong_password_is_told_and_nothing_else(stranger: Page) -> None:
    stranger.goto("/login")
    _log_in(stranger, "not the secret")
    expect(stranger.get_by_role("alert")).to_be_visible()
    assert urlsplit(stranger.url).path == "/login"


def test_the_way_on_never_leads_to_another_host(stranger: Page, guarded_ponthy: str) -> None:
    stranger.goto("/login?next=https://elsewhere.example/cars")
    _log_in(stranger, PASSWORD)
    stranger.wait_for_url(f"{guarded_ponthy}/")


def test_a_token_is_shown_once_and_revoked(stranger: Page) -> None:
    stranger.goto("/login?next=/settings")
    _log_in(stranger, PASSWORD)
    expect(stranger.locator("#tokens")).to_contain_text("No tokens")  # the page has come alive
    stranger.get_by_role("button", name="New token…").click()
    stranger.get_by_role("dialog").get_by_label("What will use it?").fill("Logger in the van")
    stranger.keyboard.press("Enter")
    expect(stranger.locator(".token")).to_contain_text("ponthy_")
    expect(stranger.locator("#tokens tbody")).to_contain_text("Logger in the van")
    stranger.reload()
    expect(stranger.locator(".token")).to_have_count(0)
    stranger.get_by_role("button", name="Revoke").click()
    stranger.get_by_role("dialog").get_by_role("button", name="Revoke").click()
    expect(stranger.locator("#tokens")).to_contain_text("No tokens")
