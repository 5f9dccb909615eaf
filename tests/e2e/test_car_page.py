"""The car page: the map in its forms, its versions and exports, trips left out, the file as form and as text."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.support import Uploaded, Watch, api, eventually

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

TYPES = "() => document.querySelector('#map-figure .plot').data.map((trace) => trace.type)"


@pytest.fixture
def page(open_page: Opener, uploaded: Uploaded) -> Page:
    opened = open_page(f"/cars/{uploaded.car_id}")
    expect(opened.locator("#map-figure .main-svg").first).to_be_visible()
    return opened


def _switch(page: Page, name: str) -> None:
    page.get_by_label(name, exact=True).check(force=True)


def test_the_map_is_drawn_flat_in_three_dimensions_and_as_counts(page: Page) -> None:
    assert "contour" in page.evaluate(TYPES)
    _switch(page, "3-D")
    eventually(lambda: page.evaluate(TYPES) == ["surface"], "the surface")
    _switch(page, "Points per cell")
    eventually(lambda: page.evaluate(TYPES) == ["heatmap"], "the counts")
    expect(page.get_by_label("g/kWh")).to_be_disabled()
    _switch(page, "2-D")
    _switch(page, "g/kWh")
    expect(page.locator("#map-figure")).to_contain_text("g/kWh")


def test_beside_the_map_stand_its_best_point_and_how_sure_it_is(page: Page, uploaded: Uploaded) -> None:
    best = api(page, f"cars/{uploaded.car_id}")["latest_map"]["best"]
    expect(page.locator("#side .big")).to_have_text(f"{100 * best['efficiency']:.1f}\u202f%")
    expect(page.locator("#side")).to_contain_text("Below full load")


def test_a_trip_is_left_out_and_the_map_becomes_another_version(page: Page, uploaded: Uploaded) -> None:
    version = api(page, f"cars/{uploaded.car_id}")["latest_map"]["version"]
    points = api(page, f"cars/{uploaded.car_id}")["latest_map"]["points"]
    row = page.locator("#trips tbody tr", has=page.locator(f'a[href="/trips/{uploaded.trip_id}"]'))
    row.get_by_role("checkbox").uncheck()
    newer = eventually(lambda: _newer(page, uploaded.car_id, version), "a map without the trip")
    assert newer["points"] < points
    row.get_by_role("checkbox").check()
    again = eventually(lambda: _newer(page, uploaded.car_id, newer["version"]), "a map with the trip")
    assert again["points"] == points
    page.get_by_role("tab", name="Map versions").click()
    expect(page.locator("#versions tbody th").first).to_contain_text(str(again["version"]), timeout=20_000)
    page.locator("#versions").get_by_role("link", name=str(version), exact=True).click()
    expect(page.locator("#map-note")).to_contain_text(f"This is version {version}")


def _newer(page: Page, car_id: str, version: int) -> dict[str, int] | None:
    newest = api(page, f"cars/{car_id}")["latest_map"]
    return newest if newest["version"] > version else None


@pytest.mark.parametrize(("form", "start"), [("JSON", b"{"), ("CSV", b""), ("SVG", b"<?xml"), ("PNG", b"\x89PNG")])
def test_a_map_is_exported(page: Page, form: str, start: bytes) -> None:
    page.get_by_role("tab", name="Map versions").click()
    with page.expect_download(timeout=60_000) as download:
        page.locator("#versions tbody tr").first.get_by_text(form, exact=True).click()
    content = download.value.path().read_bytes()
    assert content.startswith(start)
    assert len(content) > 1000
    if form == "JSON":
        assert json.loads(content)["cell"]["rpm"] == 50


def test_the_maps_numbers_are_a_table(page: Page) -> None:
    page.locator("#map-figure").get_by_role("button", name="Show as table").click()
    expect(page.locator("#map-figure thead")).to_contain_text("Torque, Nm")
    expect(page.locator("#map-figure tbody tr")).not_to_have_count(0)


def test_the_form_refuses_an_absurd_value_beside_its_field(page: Page, watch: Watch) -> None:
    watch.expect("422")
    page.get_by_role("tab", name="Car file").click()
    drag = page.get_by_label("Drag coefficient")
    before = drag.input_value()
    drag.fill("39")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(drag).to_have_attribute("aria-invalid", "true")
    expect(drag).to_be_focused()
    expect(page.locator("#file-view .error:visible")).to_contain_text("between")
    drag.fill(before)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.locator("#file-view")).to_contain_text("Nothing has changed")


def test_the_forms_battery_is_folded_and_takes_a_pasted_column(page: Page, watch: Watch) -> None:
    watch.expect("422")
    page.get_by_role("tab", name="Car file").click()
    expect(page.get_by_label("Rated capacity")).to_be_hidden()
    page.get_by_text("Of electric and hybrid cars").click()
    charge = page.get_by_label("Open-circuit curve, states of charge")
    charge.fill("0\n50\n100")
    page.get_by_label("Open-circuit curve, volts").fill("3\n3.3\n3.5")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(charge).to_be_focused()
    expect(page.locator("#file-view .error:visible")).to_contain_text("“0 50 100” must lie between")


def test_the_form_saves_one_value_and_keeps_the_rest(page: Page, uploaded: Uploaded) -> None:
    page.get_by_role("tab", name="Car file").click()
    page.get_by_label("Colour").fill("anthracite")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.locator("#file-view")).to_contain_text("Saved")
    expect(page.locator("#file-view").get_by_role("button", name="Run all trips again")).to_be_visible()
    assert api(page, f"cars/{uploaded.car_id}")["vehicle"]["color"] == "anthracite"
    _switch(page, "History")
    expect(page.locator("#file-view tbody tr")).to_have_count(2)


def test_the_load_is_set_beside_the_file(page: Page, uploaded: Uploaded) -> None:
    mass = api(page, f"cars/{uploaded.car_id}")["vehicle"]["mass_kg"]
    page.get_by_role("tab", name="Car file").click()
    page.get_by_label("Load", exact=True).fill("155")
    page.get_by_role("button", name="Save load").click()
    expect(page.locator("#facts")).to_contain_text(f"{mass + 80:.0f}")
    assert api(page, f"cars/{uploaded.car_id}")["load_kg"] == 155.0


def test_a_refused_line_of_the_xml_is_marked(page: Page, watch: Watch) -> None:
    watch.expect("422")
    page.get_by_role("tab", name="Car file").click()
    _switch(page, "XML")
    editor = page.get_by_label("XML of the car")
    lines = editor.input_value().split("\n")
    wrong = next(number for number, line in enumerate(lines) if "<mass" in line)
    lines[wrong] = '<mass wet="heavy"/>'
    editor.fill("\n".join(lines))
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.locator(".editor li.bad")).to_have_text(str(wrong + 1))
    expect(page.get_by_role("alert")).to_contain_text(f"line {wrong + 1}")
