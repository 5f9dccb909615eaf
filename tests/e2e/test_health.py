"""A car's health on its page: what changed in words, trends that lead to trips, what was seen and taken as usual."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from tests.e2e.support import Uploaded, api, eventually

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

WORDS = "Rolling resistance 18 % above its usual, since 3 trips"


def changed(real: dict[str, Any], trip_id: str) -> dict[str, Any]:
    """What a car with a soft tyre would say."""
    alert = {
        "id": "1" * 32,
        "car_id": real["car_id"],
        "car_name": "car",
        "quantity": "rolling_resistance",
        "state": "open",
        "words": WORDS,
        "advice": "Check the tyre pressures.",
        "chance": 0.97,
        "since_trip_id": trip_id,
        "since_at": "2026-03-01T08:00:00Z",
        "cleared_words": "",
    }
    trend = {
        "quantity": "rolling_resistance",
        "title": "Rolling resistance",
        "unit": "%",
        "words": f"{WORDS}.",
        "trip_ids": [trip_id],
        "names": ["trip"],
        "estimate": [18.2],
        "sd": [3.1],
        "band": 9.0,
    }
    found = {"state": "alert", "reason": "", "alerts": [alert], "trends": [trend], "baseline_trips": 10}
    return real | found | {"false_alarms_per_200_trips": 0.1}


def figure(trip_id: str) -> dict[str, Any]:
    trace = {"type": "scatter", "mode": "markers", "name": "change", "x": [1], "y": [18.2], "customdata": [[trip_id]]}
    return {"data": [trace], "layout": {"height": 260}}


@pytest.fixture
def posted() -> list[tuple[str, Any]]:
    """What was asked of the server."""
    return []


@pytest.fixture
def page(open_page: Opener, uploaded: Uploaded, posted: list[tuple[str, Any]]) -> Page:
    """Return the page of a car that has changed."""
    opened = open_page("/cars")
    real = api(opened, f"cars/{uploaded.car_id}/health")

    def asked(route: Route) -> None:
        posted.append((route.request.url.rpartition("/")[2], json.loads(route.request.post_data or "null")))
        route.fulfill(status=202, json={"usual_since": None, "job_id": "2" * 32})

    opened.route("**/health", lambda route: route.fulfill(json=changed(real, uploaded.trip_id)))
    opened.route("**/health/figures/**", lambda route: route.fulfill(json=figure(uploaded.trip_id)))
    opened.route("**/health/alerts/*/seen", asked)
    opened.route("**/health/usual", asked)
    opened.goto(f"/cars/{uploaded.car_id}#health")
    expect(opened.locator("#health .proposal")).to_have_count(1)
    return opened


def test_the_first_trip_was_assessed_and_says_how_many_are_needed(open_page: Opener, uploaded: Uploaded) -> None:
    opened = open_page(f"/cars/{uploaded.car_id}#health")
    said = api(opened, f"cars/{uploaded.car_id}/health")
    assert (said["state"], said["baseline_needed"]) == ("unknown", 10)
    assert said["trips"][0]["role"] == "baseline"
    expect(opened.locator("#health")).to_contain_text(said["reason"])
    expect(opened.locator("#health .verdict").first).to_have_text("○not known yet")


def test_a_change_is_told_in_words_with_a_shape_in_every_place(page: Page) -> None:
    expect(page.locator("#health .proposal")).to_contain_text(WORDS)
    expect(page.locator("#health .proposal .verdict")).to_have_text("■open")
    expect(page.locator("#health .proposal")).to_contain_text("Check the tyre pressures.")
    expect(page.locator("#side")).to_contain_text(WORDS)
    expect(page.locator("#facts")).to_contain_text("changed")
    page.locator("#health summary").first.click()
    expect(page.locator("#health tbody tr").filter(has_text="18.2 ±\u202f3.1\u202f%")).to_have_count(1)


def test_a_point_of_the_trend_leads_to_its_trip(page: Page, uploaded: Uploaded) -> None:
    expect(page.locator("#health .trends .main-svg").first).to_be_visible()
    expect(page.locator("#map-figure .main-svg").first).to_be_visible()
    expect(page.locator("#side")).to_contain_text(WORDS)  # nothing moves any more
    point = page.locator("#health .trends .points path").first
    point.scroll_into_view_if_needed()
    eventually(lambda: click(page, point) or page.url.endswith(f"/trips/{uploaded.trip_id}"), "the point's trip", 30)


def click(page: Page, point: Locator) -> None:
    """Click on a point where it is at the moment: what loads above it still moves it now and then."""
    page.wait_for_timeout(500)
    place = point.bounding_box() if point.count() else None
    if place is None:
        return  # drawn anew just now, or the trip's page has come
    middle = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
    page.mouse.move(middle[0] - 20, middle[1])
    page.mouse.move(*middle, steps=3)
    page.mouse.click(*middle, delay=50)
    page.wait_for_timeout(500)


def test_an_alert_is_seen_and_taken_as_usual_only_after_a_yes(
    page: Page, uploaded: Uploaded, posted: list[tuple[str, Any]]
) -> None:
    with page.expect_response("**/seen"):
        page.get_by_role("button", name="I have seen it").click()
    assert posted == [("seen", {})]
    page.get_by_role("button", name="This is its new usual…").click()
    expect(page.get_by_role("dialog")).to_contain_text("This can be taken back")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    assert len(posted) == 1
    page.get_by_role("button", name="This is its new usual…").click()
    page.get_by_role("button", name="Take as usual").click()
    expect(page.locator(".toast")).to_contain_text("assessed anew")
    assert posted[1:] == [("usual", {"since_trip_id": uploaded.trip_id})]


def test_the_overview_lists_cars_that_have_changed(open_page: Opener, uploaded: Uploaded) -> None:
    opened = open_page("/cars")
    real = api(opened, f"cars/{uploaded.car_id}/health")
    alerts = {"items": changed(real, uploaded.trip_id)["alerts"], "next_cursor": None}
    opened.goto("/")
    expect(opened.locator("#cars")).to_be_visible()
    expect(opened.locator("#alerts")).to_be_hidden()
    opened.route("**/alerts?*", lambda route: route.fulfill(json=alerts))
    opened.reload()
    expect(opened.locator("#alert-list")).to_contain_text(WORDS)
    opened.locator("#alert-list").get_by_role("link").click()
    expect(opened.get_by_role("tab", name="Health")).to_have_attribute("aria-selected", "true")
