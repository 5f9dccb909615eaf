"""A drive posed on its page, solved by a worker, told in words, compared with another; and what is impossible."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from app.drives.schemas import ACCELERATE
from tests.e2e.support import Uploaded, Watch, api

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

FAULTS = (Path(__file__).parent / "accessibility.js").read_text()
SOLVED_MS = 120_000
PHONE = {"width": 390, "height": 844}


def posed(page: Page, name: str, **changed: Any) -> str:
    """Have the thesis' acceleration solved, with some fields changed; returns the drive's identifier."""
    body = {"name": name, "problem": ACCELERATE | changed}
    answer = page.request.post("/api/v1/drives?wait=30", data=body, timeout=SOLVED_MS)
    assert answer.ok, answer.text()
    return str(answer.json()["id"])


def test_an_acceleration_is_posed_for_a_car_and_told_in_words(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page(f"/drives/new?car={uploaded.car_id}")
    expect(page.locator("#pose-check")).to_have_text("The problem can be solved as it stands.")
    page.get_by_label("To", exact=True).fill("80")
    page.get_by_role("button", name="Solve it").click()
    expect(page.locator("#advice")).to_contain_text("km/h", timeout=SOLVED_MS)
    drive = api(page, f"drives/{page.url.rsplit('/', 1)[1]}")
    assert drive["car_id"] == uploaded.car_id
    answer = api(page, f"drives/{drive['id']}/answer")
    assert answer["trajectory"]["speed_mps"][-1] == pytest.approx(80.0 / 3.6, abs=1e-9)
    expect(page.locator("#facts")).to_contain_text(f"{answer['time_s']:.{2 if answer['time_s'] < 10 else 1}f}")
    expect(page.locator("#stack .main-svg").first).to_be_visible()
    expect(page.locator("#path .main-svg").first).to_be_visible()
    page.locator("#cursor-slider").focus()
    page.keyboard.press("End")
    expect(page.locator("#readout")).to_contain_text("80.00")
    page.get_by_role("tab", name="How one knows").click()
    expect(page.locator("#panel-certificate")).to_contain_text("Hamiltonian drift")


def test_two_drives_are_laid_over_each_other_and_methods_compared(open_page: Opener) -> None:
    page = open_page("/drives")
    free, fast = posed(page, "Whatever takes least"), posed(page, "In eight seconds", time_s=8.0)
    page.reload()
    for name in ("Whatever takes least", "In eight seconds"):
        page.get_by_label(f"Compare {name}").first.check()
    page.get_by_role("button", name="Compare these two").click()
    expect(page.locator("#differences")).to_contain_text("8.00\u202fs")
    assert page.evaluate(FAULTS) == []
    two = {"methods": ["pontryagin", "dp_speed"]}  # all of them would take the test too long
    assert page.request.post(f"/api/v1/drives/{free}/compare", data=two).ok
    page.goto(f"/drives/{free}#methods")
    expect(page.get_by_role("button", name="Compare methods")).to_be_visible()
    expect(page.get_by_role("heading", name="Error and time")).to_be_visible(timeout=SOLVED_MS)
    expect(page.locator("#panel-methods")).to_contain_text("Dynamic programming")
    page.set_viewport_size(PHONE)
    page.goto(f"/drives/{fast}")
    expect(page.locator("#stack .main-svg").first).to_be_visible()
    assert page.evaluate("() => document.documentElement.scrollWidth") <= PHONE["width"]
    assert page.evaluate(FAULTS) == []


def test_what_is_wrong_is_said_beside_its_field_and_what_is_impossible_leads_back(
    open_page: Opener, watch: Watch
) -> None:
    watch.expect("422")
    page = open_page("/drives/new")
    expect(page.locator("#pose-check")).to_have_text("The problem can be solved as it stands.")
    page.get_by_label("To", exact=True).fill("20")
    expect(page.locator('[data-path="to_speed_mps"] .error')).to_contain_text("is not above from_speed_mps")
    page.get_by_label("To", exact=True).fill("100")
    page.get_by_label("In which time").select_option("Exactly")
    page.get_by_label("Exactly, seconds").fill("2")
    expect(page.locator('[data-path="to_speed_mps"] .error')).to_be_hidden()
    page.get_by_role("button", name="Solve it").click()
    expect(page.locator("#drive-failure")).to_contain_text("too short by 4.669 s", timeout=SOLVED_MS)
    page.get_by_role("link", name="Change the problem").click()
    expect(page.locator('[data-path="time_s"] .error')).to_contain_text("too short by 4.669 s")
    page.get_by_label("JSON", exact=True).check(force=True)
    area = page.get_by_label(re.compile("The problem in SI units"))
    assert json.loads(area.input_value())["time_s"] == 2
    area.fill("{")
    expect(page.locator("#pose-outcome")).to_contain_text("Not JSON yet")
