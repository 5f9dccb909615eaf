"""The calibration on the car page: proposals are shown with their evidence, and applied only when the reader agrees."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from tests.e2e.support import Uploaded, api, eventually

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

TICK = "vss/calibration@metersPerTick"


def change(field: str, label: str, before: float | None, after: float, sd: float) -> dict[str, Any]:
    return {"field": field, "label": label, "unit": "m", "before": before, "after": after, "sd": sd}


def proposal(name: str, title: str, confidence: str, *changes: dict[str, Any]) -> dict[str, Any]:
    applicable = confidence != "weak" and bool(changes[0]["field"])
    said = {"name": name, "title": title, "confidence": confidence, "changes": changes, "trips": 3}
    return said | {"evidence": [f"Evidence of {name}."], "applicable": applicable}


PROPOSALS = [
    proposal("vss_m_per_tick", "Metres per wheel tick", "sure", change(TICK, "Distance", 0.270184, 0.26881, 0.00012)),
    proposal("injector_lag", "Injector lag", "likely", change("inj/calibration@lag", "Lag", None, 0.8, 0.1)),
    proposal("gps_latency", "Delay of the position fixes", "sure", change("", "Delay", None, 0.31, 0.02)),
]


def quantity(file: float, value: float, sd: float, identified: bool) -> dict[str, Any]:
    shares = [{"source": "prior", "share": 0.25}, {"source": "cruising", "share": 0.75}]
    return {"file": file, "value": value, "sd": sd, "identified": identified, "shares": shares}


ROAD_LOAD = {
    "model": "fuel",
    "mass_kg": quantity(919.0, 919.0, 46.0, False),
    "cd_area_m2": quantity(0.979, 0.7534, 0.0391, True),
    "crr": quantity(0.007, 0.00995, 0.0003, True),
    "cd_area_sd_given_mass_m2": 0.008,
    "correlation": -0.4,
    "trips": 3,
    "driving_windows": 4200,
    "coasting_windows": 0,
    "hours": 2.4,
    "levels": {
        "before": 0.308,
        "after": 0.277,
        "best": {"rpm": 3375.0, "before": 0.372, "after": 0.341, "nm_before": 80.0, "nm_after": 74.0},
        "by_load": [{"fuel_power_w": 40000.0, "before": 0.26, "after": 0.235}],
    },
    "reasons": ["The mass rests on the car's file."],
    "warnings": ["Wind is taken as none."],
}


CHANGED = {"proposals": PROPOSALS, "road_load": ROAD_LOAD, "key": "k"}


@pytest.fixture
def asked() -> list[dict[str, Any]]:
    """What was asked to be applied."""
    return []


@pytest.fixture
def page(open_page: Opener, uploaded: Uploaded, asked: list[dict[str, Any]]) -> Page:
    """Return a car's page whose calibration has something to propose."""
    opened = open_page(f"/cars/{uploaded.car_id}")
    real = api(opened, f"cars/{uploaded.car_id}/calibration")

    def applied(route: Route) -> None:
        asked.append(json.loads(route.request.post_data or ""))
        route.fulfill(status=202, json={"revision": 2, "note": "", "jobs": [{}]})

    opened.route("**/calibration", lambda route: route.fulfill(json=real | CHANGED))
    opened.route("**/calibration/apply", applied)
    opened.get_by_role("tab", name="Calibration").click()
    expect(opened.locator(".proposal")).to_have_count(3)
    return opened


def test_a_proposal_shows_before_after_uncertainty_evidence_and_how_sure_it_is(page: Page) -> None:
    first = page.locator(".proposal").first
    expect(first.get_by_role("row").nth(1)).to_have_text("Distance, m0.270180.26881 ±\u202f0.00012")
    expect(first).to_contain_text("Evidence of vss_m_per_tick.")
    expect(first.locator(".verdict")).to_have_text("●sure")
    expect(page.locator(".proposal").nth(1).locator(".verdict")).to_have_text("◐likely")
    expect(page.locator(".proposal").nth(2).get_by_role("checkbox")).to_have_count(0)


def test_the_efficiency_is_shown_before_and_after_another_road_load(page: Page) -> None:
    road = page.get_by_role("table", name="Road load")
    expect(road.get_by_role("row", name="Drag area C_d·A")).to_contain_text("0.9790.753 ±\u202f0.039")
    expect(road.get_by_role("row", name="Rolling resistance C_rr")).to_contain_text(
        "the car file 25\u202f%, cruising 75\u202f%"
    )
    levels = page.get_by_role("table", name="Efficiency before and after")
    expect(levels.get_by_role("row", name="All driving")).to_contain_text("30.8\u202f%27.7\u202f%−3.1")
    expect(levels.get_by_role("row", name="Best point, 3\u202f375 rpm and 80 Nm")).to_contain_text("−3.1")
    expect(page.get_by_text("Wind is taken as none.")).to_be_visible()


def test_only_what_is_ticked_is_applied_and_only_after_a_yes(page: Page, asked: list[dict[str, Any]]) -> None:
    expect(page.get_by_role("checkbox", name="Metres per wheel tick")).to_be_checked()
    expect(page.get_by_role("checkbox", name="Injector lag")).not_to_be_checked()
    page.get_by_role("button", name="Apply and run again…").focus()
    page.keyboard.press("Enter")
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("Metres per wheel tick")
    expect(dialog).not_to_contain_text("Injector lag")
    expect(dialog).to_contain_text("the trip of this car runs again")
    page.keyboard.press("Escape")
    expect(dialog).to_have_count(0)
    assert asked == []
    page.get_by_role("checkbox", name="Injector lag").check()
    page.get_by_role("button", name="Apply and run again…").click()
    page.get_by_role("button", name="Apply and run 1\u202ftrip again").click()
    expect(page.locator(".toast")).to_contain_text("revision 2")
    assert asked == [{"names": ["vss_m_per_tick", "injector_lag"], "key": "k"}]


def test_with_nothing_ticked_nothing_is_asked(page: Page) -> None:
    page.get_by_role("checkbox", name="Metres per wheel tick").uncheck()
    page.get_by_role("button", name="Apply and run again…").click()
    expect(page.locator(".toast")).to_contain_text("Tick what is to be changed")
    expect(page.get_by_role("dialog")).to_have_count(0)


def test_a_filling_is_noted_beside_its_trip(page: Page, uploaded: Uploaded) -> None:
    page.locator("#calibration summary").first.click()
    litres = page.locator("#calibration td.filling input")
    litres.fill("31,4")
    litres.press("Tab")
    eventually(lambda: api(page, f"trips/{uploaded.trip_id}")["refuelled_l"] == 31.4, "the litres to be saved")
    litres.fill("")
    litres.press("Tab")
    eventually(lambda: api(page, f"trips/{uploaded.trip_id}")["refuelled_l"] is None, "the litres to be forgotten")


def test_a_car_that_has_not_driven_is_told_what_is_needed(open_page: Opener) -> None:
    opened = open_page("/cars")
    car = opened.request.post("/api/v1/cars", data={"name": "New"}).json()
    opened.goto(f"/cars/{car['id']}#calibration")
    empty = opened.locator("#calibration .empty")
    expect(empty).to_contain_text("Nothing is known from driving yet")
    expect(empty.get_by_role("link", name="Upload a trip")).to_be_visible()
    opened.request.delete(f"/api/v1/cars/{car['id']}")


def test_an_older_car_file_is_put_back(open_page: Opener) -> None:
    opened = open_page("/cars")
    car = opened.request.post("/api/v1/cars", data={"name": "Restored"}).json()
    url = f"/api/v1/cars/{car['id']}"
    before = opened.request.get(f"{url}/config").text()
    opened.request.put(f"{url}/config/form", data={"values": {TICK: 0.3}})
    opened.goto(f"/cars/{car['id']}#file")
    opened.get_by_label("History").check(force=True)
    opened.get_by_role("button", name="Put revision 1 back").click()
    expect(opened.locator("#file-view tbody tr")).to_have_count(3)
    expect(opened.locator("#file-view tbody tr").first).to_contain_text("Revision 1 again")
    assert opened.request.get(f"{url}/config").text() == before
    opened.request.delete(url)
