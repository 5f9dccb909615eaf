"""A trip's score in a real browser: what to do, where it was lost, acceleration by acceleration, and the car's card."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, Route, expect

from app.eco.schemas import CAR_EXAMPLE, RANK_EXAMPLE
from app.figures.score_accelerations import accelerations_figure
from app.figures.score_along import along_figure
from app.figures.score_cells import cells_figure
from app.figures.score_parts import parts_figure
from app.figures.score_place import place_plan_figure
from tests.e2e.support import ROOT, Uploaded, Watch
from tests.eco.conftest import ROWS, judged

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

FAULTS = (ROOT / "tests" / "e2e" / "accessibility.js").read_text()
SCORE = judged(86.0)
PLACES = {"north_m": np.linspace(0.0, 900.0, ROWS), "east_m": np.linspace(0.0, 100.0, ROWS)}
FIGURES: dict[str, dict[str, Any]] = {
    "along": along_figure(SCORE.along),
    "parts": parts_figure(SCORE),
    "cells": cells_figure(SCORE),
    "accelerations": accelerations_figure(SCORE.accelerations),
    "place": place_plan_figure(SCORE.along, PLACES),
}
ABOUT = {"map_version": 1, "newest_map_version": 2, "scored_at": "2026-03-01T08:00:00Z", "provenance": {}}
NOT_YET = {"code": "not-scored", "title": "Conflict", "detail": "This trip has not been scored yet.", "status": 409}


@pytest.fixture
def page(open_page: Opener, uploaded: Uploaded) -> Page:
    """Return a page on which the uploaded trip has a score, whatever its worker is at."""
    opened = open_page("/cars")
    trip = {"trip_id": uploaded.trip_id, "car_id": uploaded.car_id}
    of_car = CAR_EXAMPLE | {"car_id": uploaded.car_id, "advice_trip_id": uploaded.trip_id}
    of_car["trips"] = [CAR_EXAMPLE["trips"][0] | {"trip_id": uploaded.trip_id}]
    ranked = RANK_EXAMPLE | {"car_id": uploaded.car_id}

    def rank(route: Route) -> None:
        one = ranked | ({**trip, "trip_name": "To work"} if "by=trip" in route.request.url else {})
        route.fulfill(json={"items": [one], "next_cursor": None})

    opened.route("**/trips/*/score", lambda route: route.fulfill(json=SCORE.document() | trip | ABOUT))
    opened.route("**/figures/score-*", lambda route: route.fulfill(json=FIGURES[drawn(route)]))
    opened.route("**/cars/*/score", lambda route: route.fulfill(json=of_car))
    opened.route("**/scores?*", rank)
    return opened


def drawn(route: Route) -> str:
    return route.request.url.partition("/score-")[2].partition("?")[0]


def test_a_trip_says_what_it_could_have_saved_and_where(page: Page, uploaded: Uploaded) -> None:
    page.goto(f"/trips/{uploaded.trip_id}#score")
    panel = page.locator("#panel-score")
    expect(panel.get_by_role("heading").first).to_have_text(
        "This trip could have taken 0.28\u202fL less (14 ± 2\u202f%)"
    )
    expect(panel.locator(".score strong")).to_have_text("86")
    expect(panel).to_contain_text("Shift up at 2500 rpm instead of 3400")
    expect(panel.get_by_role("button", name="Score with the newest map")).to_be_visible()
    expect(panel.locator(".figure")).to_have_count(len(FIGURES))
    expect(panel.locator(".figure .plot .waiting")).to_have_count(0)
    parts = panel.locator(".figure").nth(1)
    parts.get_by_role("button", name="Show as table").click()
    expect(parts.locator("tbody tr")).to_have_count(len(SCORE.parts) + 1)
    panel.get_by_text("Every acceleration (1)").click()
    expect(panel.get_by_role("region", name="Every acceleration")).to_contain_text("brisk, shifts at 3400 rpm")
    panel.get_by_text("Stretches between stops (1 of 2 scored)").click()
    expect(panel.get_by_role("region", name="Stretches")).to_contain_text("Too short.")
    assert page.evaluate(FAULTS) == []


def test_a_trip_without_a_score_offers_one(page: Page, uploaded: Uploaded, watch: Watch) -> None:
    watch.expect("409")
    job = {"id": "1" * 32, "kind": "score", "state": "queued", "title": "Score", "stages": [], "attempt": 0}
    answers = {
        "POST": {"status": 202, "json": job | {"trip_id": uploaded.trip_id}},
        "GET": {"status": 409, "json": NOT_YET},
    }
    page.route("**/trips/*/score", lambda route: route.fulfill(**answers[route.request.method]))
    page.goto(f"/trips/{uploaded.trip_id}#score")
    expect(page.locator("#panel-score")).to_contain_text(NOT_YET["detail"])
    page.get_by_role("button", name="Score this trip").click()
    expect(page.locator("#trip-job .job")).to_be_visible()


def test_the_car_says_how_to_drive_it_on_less_and_is_ranked(page: Page, uploaded: Uploaded) -> None:
    page.goto(f"/cars/{uploaded.car_id}")
    card = page.locator("#side .card", has_text="Drive it on less")
    expect(card).to_contain_text("14 ±\u202f2\u202f% (0.31\u202fL)")
    expect(card.get_by_role("link", name="Pose a drive")).to_have_attribute(
        "href", f"/drives/new?car={uploaded.car_id}"
    )
    card.get_by_role("link", name="See To work").click()
    expect(page.get_by_role("tab", name="Eco-score")).to_have_attribute("aria-selected", "true")
    page.goto("/")
    expect(page.locator("#ranked tbody")).to_contain_text("Smart Roadster")
    page.locator("#ranking").get_by_label("Trips").check(force=True)
    expect(page.locator("#ranked tbody a")).to_have_attribute("href", f"/trips/{uploaded.trip_id}#score")
