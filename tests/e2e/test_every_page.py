"""What holds on every page: names for everything that can be used, keyboard, phone, dark."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.support import Uploaded, Watch

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

PAGES = [
    "/",
    "/cars",
    "/cars/{car}",
    "/cars/{car}#fits",
    "/cars/{car}#health",
    "/cars/{car}#calibration",
    "/cars/{car}#file",
    "/trips",
    "/trips/{trip}",
    "/trips/{trip}#told",
    "/trips/{trip}#decoded",
    "/trips/{trip}#numbers",
    "/trips/{trip}/dashboard",
    "/drives",
    "/batteries",
    "/drives/new",
    "/upload",
    "/jobs",
    "/settings",
    "/login",
]
WITHOUT_RAIL = ("/login", "/trips/{trip}/dashboard")
FAULTS = (Path(__file__).parent / "accessibility.js").read_text()
SETTLED_MS = 1500


def _path(pattern: str, uploaded: Uploaded) -> str:
    return pattern.format(car=uploaded.car_id, trip=uploaded.trip_id)


@pytest.mark.parametrize("pattern", PAGES)
def test_everything_that_can_be_used_has_a_name_and_a_place(
    open_page: Opener, uploaded: Uploaded, pattern: str
) -> None:
    page = open_page(_path(pattern, uploaded))
    page.wait_for_timeout(SETTLED_MS)
    assert page.evaluate(FAULTS) == []
    assert page.title().endswith("Ponthy")


@pytest.mark.parametrize("pattern", PAGES)
def test_a_phone_shows_every_page_without_scrolling_sideways(
    open_page: Opener, uploaded: Uploaded, pattern: str
) -> None:
    phone = {"width": 390, "height": 844}
    page = open_page(_path(pattern, uploaded), viewport=phone, has_touch=True, is_mobile=True)
    page.wait_for_timeout(SETTLED_MS)
    assert page.evaluate("() => document.documentElement.scrollWidth") <= phone["width"]
    if pattern not in WITHOUT_RAIL:
        bar = page.locator(".rail").bounding_box()
        assert bar is not None
        assert bar["y"] + bar["height"] == pytest.approx(phone["height"], abs=1)


def test_a_page_that_is_not_there_keeps_to_the_same_rules(open_page: Opener, watch: Watch) -> None:
    watch.expect("404")
    page = open_page("/nothing/of/this/name", viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    expect(page.get_by_role("heading", level=1)).to_have_text("404 · Nothing is here")
    assert page.evaluate(FAULTS) == []
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 390
    page.get_by_role("link", name="To the overview", exact=True).click()
    expect(page).to_have_title("Overview · Ponthy")


def test_the_system_chooses_the_theme_and_the_switch_overrides_it(open_page: Opener) -> None:
    page = open_page("/settings", color_scheme="dark")
    ground = "() => getComputedStyle(document.documentElement).backgroundColor"
    assert page.evaluate(ground) == "rgb(20, 23, 26)"
    page.get_by_label("Light").check(force=True)
    assert page.evaluate(ground) == "rgb(251, 251, 249)"
    page.goto("/cars")
    assert page.evaluate(ground) == "rgb(251, 251, 249)"
    page.goto("/settings")
    expect(page.get_by_label("Light")).to_be_checked()
    page.get_by_label("As the system").check(force=True)
    assert page.evaluate(ground) == "rgb(20, 23, 26)"


def test_figures_follow_the_theme(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page(f"/cars/{uploaded.car_id}", color_scheme="light")
    expect(page.locator("#map-figure .main-svg").first).to_be_visible()
    colour = "() => document.querySelector('#map-figure .plot').layout.font.color"
    light = page.evaluate(colour)
    page.emulate_media(color_scheme="dark")
    page.wait_for_timeout(SETTLED_MS)
    assert page.evaluate(colour) != light


def test_the_keyboard_reaches_content_rail_and_dialogs(open_page: Opener) -> None:
    page = open_page("/cars")
    expect(page.locator(".waiting")).to_have_count(0)
    page.keyboard.press("Tab")
    expect(page.get_by_role("link", name="Skip to the content")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#content")).to_be_focused()
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="New car")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_be_hidden()
    expect(page.get_by_role("button", name="New car")).to_be_focused()


def test_the_rail_marks_where_one_is(open_page: Opener) -> None:
    page = open_page("/jobs")
    expect(page.get_by_role("navigation").get_by_role("link", name="Jobs")).to_have_attribute("aria-current", "page")
