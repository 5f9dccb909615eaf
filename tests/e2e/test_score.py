"""A trip's score in a real browser: what to do, where it was lost, acceleration by acceleration, and the car's card."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from tests.e2e.support import ROOT, Uploaded, api, eventually

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]
FAULTS = (ROOT / "tests" / "e2e" / "accessibility.js").read_text()
FIGURES = 5


@pytest.fixture
def scored(open_page: Opener, uploaded: Uploaded) -> dict[str, Any]:
    """Wait until the uploaded trip's score is there, and return what it says."""
    page = open_page("/cars")
    of_trip = f"/api/v1/trips/{uploaded.trip_id}/score"
    eventually(lambda: page.request.get(of_trip).json().get("code") != "not-scored", "the score", 240)
    score: dict[str, Any] = api(page, f"trips/{uploaded.trip_id}/score")
    return score


def test_a_trip_says_what_it_could_have_saved_and_where(
    open_page: Opener, uploaded: Uploaded, scored: dict[str, Any]
) -> None:
    page = open_page(f"/trips/{uploaded.trip_id}#score")
    panel = page.locator("#panel-score")
    expect(panel.locator(".score strong")).to_have_text(f"{scored['score']['value']:.0f}")
    expect(panel.locator(".main-svg").first).to_be_visible()
    expect(panel.locator(".figure .plot .waiting")).to_have_count(0)
    for text in scored["advice"]:
        expect(panel).to_contain_text(text)
    panel.locator(".figure").nth(1).get_by_role("button", name="Show as table").click()
    expect(panel.locator(".figure").nth(1).locator("tbody tr")).to_have_count(len(scored["parts"]) + 1)
    assert panel.locator(".figure").count() == FIGURES
    panel.get_by_text("Every acceleration").click()
    expect(panel.get_by_role("region", name="Every acceleration")).to_be_visible()
    assert page.evaluate(FAULTS) == []


def test_a_trip_without_a_score_offers_one(open_page: Opener, uploaded: Uploaded, scored: dict[str, Any]) -> None:
    page = open_page("/cars")
    problem = {"code": "not-scored", "title": "Conflict", "detail": "This trip has not been scored yet.", "status": 409}
    page.route("**/score", lambda route: unscored(route, problem))
    page.goto(f"/trips/{uploaded.trip_id}#score")
    expect(page.locator("#panel-score")).to_contain_text(problem["detail"])
    with page.expect_response(lambda answer: answer.request.method == "POST") as asked:
        page.get_by_role("button", name="Score this trip").click()
    assert asked.value.json()["kind"] == "score"
    expect(page.locator("#trip-job .job")).to_be_visible()


def unscored(route: Route, problem: dict[str, Any]) -> None:
    if route.request.method == "POST":
        route.continue_()
    else:
        route.fulfill(status=409, json=problem)


def test_the_car_says_how_to_drive_it_on_less_and_is_ranked(
    open_page: Opener, uploaded: Uploaded, scored: dict[str, Any]
) -> None:
    page = open_page(f"/cars/{uploaded.car_id}")
    card = page.locator("#side .card", has_text="Drive it on less")
    expect(card.get_by_role("link", name="Pose a drive")).to_have_attribute(
        "href", f"/drives/new?car={uploaded.car_id}"
    )
    card.get_by_role("link", name="See").click()
    expect(page.get_by_role("tab", name="Eco-score")).to_have_attribute("aria-selected", "true")
    page.goto("/")
    expect(page.locator("#ranked")).to_contain_text(f"{scored['score']['value']:.0f}")
    page.locator("#ranking").get_by_label("Trips").check(force=True)
    expect(page.locator("#ranked tbody a")).to_have_attribute("href", f"/trips/{uploaded.trip_id}#score")
