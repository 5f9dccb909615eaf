"""A trip played on the dashboard: the display follows the time, by itself, by slider and by keys."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.support import Uploaded, api

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]
KMH = 3.6


def test_the_display_shows_the_moment_and_plays_on(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page(f"/trips/{uploaded.trip_id}/dashboard", viewport={"width": 390, "height": 844})
    trip = api(page, f"trips/{uploaded.trip_id}/dashboard")
    columns, step = trip["columns"], trip["step_s"]
    k = next(k for k, target in enumerate(columns["target_mps"]) if target is not None and columns["efficiency"][k])
    slider = page.get_by_role("slider", name="Time in the trip")
    slider.evaluate("(one, t) => { one.value = t; one.dispatchEvent(new Event('input')); }", k * step)
    expect(page.locator("#dash-now")).to_have_text(f"{KMH * columns['speed_mps'][k]:.0f}")
    expect(page.locator("#dash-target")).to_contain_text(f"{KMH * columns['target_mps'][k]:.0f}")
    expect(page.locator("#dash-efficiency .gauge")).to_have_attribute("aria-label", re.compile("%"))
    expect(page.locator("#dash-arrow .arrow")).to_have_attribute("aria-label", re.compile("Faster|Slower|On target"))
    page.keyboard.press("Home")
    page.get_by_role("button", name="Play").click()
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    expect(slider).not_to_have_value("0")
    page.get_by_role("button", name="Pause").click()
    stands = float(slider.input_value())
    page.locator("#dash-title").click()
    page.keyboard.press("ArrowRight")
    assert float(slider.input_value()) == pytest.approx(stands + 5.0, abs=1e-6)
