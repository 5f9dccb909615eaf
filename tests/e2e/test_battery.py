"""A battery's pages: made for a car, fed with a file, told in words, its curve edited, its ageing looked at."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from app.science.battery.virtual.pack import VirtualPack, virtual_pack
from tests.e2e.support import Watch, api

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

FAULTS = (Path(__file__).parent / "accessibility.js").read_text()
DONE_MS = 120_000
PHONE = {"width": 390, "height": 844}
TABS = ("Ageing", "Circuit", "Fit", "Open-circuit curve", "Data", "Configuration")


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An hour and a quarter of the report's virtual pack, one row every second."""
    record = virtual_pack(VirtualPack(0.05, seed=4)).record
    file = tmp_path_factory.mktemp("battery") / "commute.csv"
    rows = zip(record.t_s, record.current_a, record.voltage_v, strict=True)
    file.write_text("t_s,current_a,voltage_v\n" + "".join(f"{t:.0f},{i:.4f},{v:.5f}\n" for t, i, v in rows))
    return file


def test_a_battery_is_made_fed_and_told(open_page: Opener, watch: Watch, measured: Path) -> None:
    watch.expect("422|409")
    page = open_page("/batteries")
    page.request.post("/api/v1/cars", data={"name": "Hybrid with a pack"})
    page.get_by_role("button", name="New battery").click()
    page.get_by_label("Car", exact=True).select_option(label="Hybrid with a pack")
    page.get_by_label("Open-circuit curve to start from").select_option(label="LFP (iron phosphate)")
    page.get_by_role("button", name="Add battery", exact=True).click()
    expect(page.locator("#new-battery-problem")).to_contain_text("Rated capacity")
    page.get_by_label("Rated capacity of one cell").fill("2,2")
    page.get_by_role("button", name="Add battery", exact=True).click()
    expect(page.locator("#battery-note")).to_contain_text("Nothing is known of it yet")
    battery = page.url.rsplit("/", 1)[1].partition("#")[0]
    assert api(page, f"batteries/{battery}/config")["rated_capacity_ah"] == 2.2
    page.get_by_role("tab", name="Data").click()
    page.set_input_files("#data-file", measured)
    expect(page.locator("#state-words")).to_contain_text("in it", timeout=DONE_MS)
    expect(page.locator("#soc-figure .main-svg").first).to_be_visible()
    for name in TABS:
        page.get_by_role("tab", name=name, exact=True).click()
        expect(page.locator(".waiting:visible")).to_have_count(0)
        assert page.evaluate(FAULTS) == []
    page.get_by_role("tab", name="Open-circuit curve").click()
    page.get_by_label("Volts, row 3").fill("2,9")
    expect(page.locator("#panel-curve .problem")).to_contain_text("Row 3")
    expect(page.get_by_label("Volts, row 3")).to_have_attribute("aria-invalid", "true")
    page.get_by_label("Volts, row 3").fill("3.21")
    expect(page.locator("#panel-curve .problem")).to_have_count(0)
    page.get_by_role("button", name="Save the curve").click()
    expect(page.locator(".toast")).to_contain_text("The curve is in the car’s file")
    assert api(page, f"batteries/{battery}/config")["ocv"][2] == [0.1, 3.21]
    page.get_by_role("tab", name="Ageing").click()
    page.get_by_label("Tested on").fill("2026-03-01")
    page.get_by_role("button", name="Add the test").click()
    expect(page.locator('[data-path="capacity_ah"] .error')).to_be_visible()
    page.locator("#test-capacity_ah").fill("1.98")
    page.get_by_role("button", name="Add the test").click()
    expect(page.get_by_role("row", name="1 Mar 2026")).to_contain_text("1.98")
    page.get_by_label("Worn out at").fill("70")
    expect(page.locator("#panel-ageing")).to_contain_text("70\u202f%")
    page.set_viewport_size(PHONE)
    page.reload()
    expect(page.locator("#soh-figure .main-svg").first).to_be_visible()
    assert page.evaluate("() => document.documentElement.scrollWidth") <= PHONE["width"]
    page.goto("/batteries")
    expect(page.get_by_role("row", name="Hybrid with a pack")).to_contain_text("%")
    page.get_by_role("link", name="The report’s figures").click()
    expect(page.locator("#report-empty")).to_contain_text("Not run yet")
    assert page.evaluate(FAULTS) == []
