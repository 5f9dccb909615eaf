"""The trip page: one time cursor over map and plots, zoom, spikes, tables, panels, exports."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest
from playwright.sync_api import Browser, Page, Playwright, expect

from tests.e2e.support import Uploaded, Watch, api, eventually

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]

RANGE = "() => document.querySelector('#stack .plot')._fullLayout.xaxis.range.map(Number)"
LINE_X = "() => new DOMMatrix(getComputedStyle(document.querySelector('.cursor-line')).transform).e"
DOT = """() => {
  const moved = new DOMMatrix(getComputedStyle(document.querySelector('.cursor-dot')).transform);
  return [moved.e, moved.f];
}"""
LARGEST = """(row) => {
  const drawn = document.querySelector('#stack .plot').data.filter((trace) => trace.hoverinfo !== 'skip')[row];
  return Math.max(...drawn.y.filter((value) => value !== null));
}"""


@pytest.fixture
def page(open_page: Opener, uploaded: Uploaded) -> Page:
    return _ready(open_page(f"/trips/{uploaded.trip_id}"))


def _ready(page: Page) -> Page:
    expect(page.locator("#stack .main-svg").first).to_be_visible()
    expect(page.locator(".cursor-dot")).to_be_visible()
    return page


def _drag(page: Page, start: float, stop: float) -> None:
    plot = page.locator("#stack .plot .nsewdrag").first.bounding_box()
    assert plot is not None
    page.mouse.move(plot["x"] + start * plot["width"], plot["y"] + 20)
    page.mouse.down()
    page.mouse.move(plot["x"] + stop * plot["width"], plot["y"] + 22, steps=5)
    page.mouse.up()


def _speed(page: Page) -> float:
    text = page.locator("#readout b").first.inner_text()
    return float(text.replace("\u202f", "").replace("−", "-"))


def test_the_mouse_moves_line_dot_slider_and_readout_together(page: Page) -> None:
    plot = page.locator("#stack .plot .nsewdrag").first.bounding_box()
    assert plot is not None
    before = page.evaluate(LINE_X), page.evaluate(DOT)
    page.mouse.move(plot["x"] + 0.5 * plot["width"], plot["y"] + 30)
    eventually(lambda: page.evaluate(LINE_X) > before[0] + 100, "the line to follow")
    eventually(lambda: page.evaluate(DOT) != before[1], "the dot to follow")
    slider = page.locator("#cursor-slider")
    middle = float(slider.input_value())
    assert middle == pytest.approx(0.5 * float(slider.get_attribute("max") or 0), rel=0.02)
    assert re.match(r"\d\d:\d\d:\d\d", slider.get_attribute("aria-valuetext") or "")


def test_the_readout_is_the_observers_value_at_the_cursor(page: Page, uploaded: Uploaded) -> None:
    page.locator("#cursor-slider").fill("321.5")
    exact = api(page, f"trips/{uploaded.trip_id}/at?t_s=321.5")
    speed = 3.6 * exact["speed_mps"]
    eventually(lambda: abs(_speed(page) - speed) < 0.006, "the exact speed")


def test_no_button_sends_a_chart_to_another_host(page: Page) -> None:
    titles = page.evaluate("() => [...document.querySelectorAll('.modebar-btn')].map((button) => button.dataset.title)")
    assert "Download plot as a PNG" in titles
    assert not [title for title in titles if "share" in title.lower() or "cloud" in title.lower()]


def test_arrow_keys_move_the_cursor_and_keys_zoom(page: Page) -> None:
    slider = page.locator("#cursor-slider")
    slider.focus()
    page.keyboard.press("ArrowRight")
    one = float(slider.input_value())
    page.keyboard.press("Shift+ArrowRight")
    assert float(slider.input_value()) == pytest.approx(11 * one)
    page.keyboard.press("End")
    assert float(slider.input_value()) == pytest.approx(float(slider.get_attribute("max") or 0))
    page.keyboard.press("Home")
    for _ in range(4):
        page.keyboard.press("Shift+ArrowRight")
    whole = page.evaluate(RANGE)
    page.keyboard.press("+")
    eventually(
        lambda: page.evaluate(RANGE)[1] - page.evaluate(RANGE)[0] < 0.6 * (whole[1] - whole[0]), "the plots to zoom"
    )
    page.keyboard.press("0")
    eventually(lambda: page.evaluate(RANGE) == whole, "the whole trip again")


def test_dragging_zooms_and_brings_finer_samples(page: Page) -> None:
    badge = page.locator("#stack .under").first
    expect(badge).to_contain_text(re.compile(r"showing .+ of .+"))
    whole = page.evaluate(RANGE)
    _drag(page, 0.40, 0.42)
    eventually(lambda: page.evaluate(RANGE)[1] - page.evaluate(RANGE)[0] < 0.05 * whole[1], "the plots to zoom")
    expect(badge).not_to_contain_text("showing")
    page.get_by_role("button", name="Whole trip").click()
    eventually(lambda: page.evaluate(RANGE) == whole, "the whole trip again")
    expect(badge).to_contain_text("showing")


def test_the_highest_single_sample_is_drawn_at_full_zoom_out(page: Page, uploaded: Uploaded) -> None:
    all_of_it = api(page, f"trips/{uploaded.trip_id}/traces?signals=thrust_n&points=4000")
    assert all_of_it["shown"] < all_of_it["total"]
    windows = [
        api(page, f"trips/{uploaded.trip_id}/traces?signals=thrust_n&from_s={t}&to_s={t + 60}&points=4000")["signals"]
        for t in range(0, 900, 60)
    ]
    highest = max(value for window in windows for value in window["thrust_n"]["value"] if value is not None)
    assert page.evaluate(LARGEST, 1) == pytest.approx(1e-3 * highest, abs=1e-3)


def _choose_layout(page: Page, name: str) -> None:
    page.locator("#layout-menu summary").click()
    page.get_by_role("button", name=name).click()


def test_map_and_plots_share_the_page_as_one_likes_and_it_is_remembered(page: Page) -> None:
    track, stack = page.locator("#track .plot"), page.locator("#stack .plot")

    def boxes() -> tuple[dict[str, float], dict[str, float]]:
        left, right = track.bounding_box(), stack.bounding_box()
        assert left is not None
        assert right is not None
        return dict(left), dict(right)

    left, right = boxes()
    assert left["x"] + left["width"] < right["x"]
    _choose_layout(page, "Map above plots")
    eventually(lambda: boxes()[0]["y"] + boxes()[0]["height"] < boxes()[1]["y"], "the map to stand above")
    eventually(lambda: boxes()[0]["width"] > 1.5 * left["width"], "the map to be wide")
    _choose_layout(page, "Map only")
    expect(stack).to_be_hidden()
    page.locator("#cursor-slider").fill("300")
    page.reload()
    expect(page.locator(".cursor-dot")).to_be_visible()
    expect(page.locator("#stack .main-svg")).to_have_count(0)
    _choose_layout(page, "Plots only")
    expect(track).to_be_hidden()
    expect(page.locator("#stack .main-svg").first).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.locator("#layout-menu")).to_be_hidden()
    expect(track).to_be_visible()
    expect(stack).to_be_visible()


def test_the_layout_is_chosen_by_keyboard(page: Page) -> None:
    menu = page.locator("#layout-menu summary")
    menu.focus()
    page.keyboard.press("Enter")
    for _ in range(3):
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(page.locator("#track")).to_be_hidden()
    expect(menu).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Plots only")).to_have_attribute("aria-pressed", "true")
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Plots only")).to_be_hidden()
    expect(menu).to_be_focused()


def test_signals_are_chosen_and_remembered(page: Page) -> None:
    page.get_by_role("button", name="+ Signal").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Altitude").check()
    dialog.get_by_label("Thrust").uncheck()
    dialog.get_by_role("button", name="Show", exact=True).click()
    expect(page.locator("#stack .annotation-text", has_text="Altitude")).to_be_visible()
    page.reload()
    expect(page.locator("#stack .annotation-text", has_text="Altitude")).to_be_visible()
    expect(page.locator("#stack .annotation-text", has_text="Thrust")).to_have_count(0)


def test_the_numbers_behind_the_plots_are_a_table(page: Page) -> None:
    page.locator("#stack").get_by_role("button", name="Show as table").click()
    table = page.locator("#stack table")
    expect(table.locator("thead")).to_contain_text("Time since the start, s")
    expect(table.locator("tbody tr")).to_have_count(200)
    page.locator("#stack select").select_option(label="Thrust, kN")
    expect(table.locator("thead")).to_contain_text("Thrust, kN")
    page.locator("#stack").get_by_role("button", name="Show as figure").click()
    expect(page.locator("#stack .main-svg").first).to_be_visible()


def test_the_panels_tell_how_sure_the_observer_is_and_what_was_in_the_file(page: Page) -> None:
    expect(page.locator("#panel-health table").first).to_contain_text("Accelerometer, forward")
    expect(page.locator("#panel-health .main-svg").first).to_be_visible()
    page.get_by_role("tab", name="Eco-score").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#panel-told table").first).to_contain_text("Without")
    expect(page.locator("#panel-told .main-svg").first).to_be_visible()
    expect(page.locator("#panel-told")).to_contain_text("Without the accelerometer, the accelerometer's biases")
    page.keyboard.press("ArrowRight")
    expect(page.locator("#points .main-svg").first).to_be_visible()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#panel-decoded")).to_contain_text("Bad checksums")
    assert page.url.endswith("#decoded")
    page.keyboard.press("ArrowRight")
    expect(page.locator("#panel-numbers")).to_contain_text("Provenance")


def test_notes_and_name_are_kept(page: Page) -> None:
    page.get_by_role("tab", name="Notes").click()
    page.get_by_label("Notes about this trip").fill("<b>wet</b> road & roof box")
    page.get_by_role("button", name="Save notes").click()
    expect(page.locator("#notes-state")).to_have_text("Saved")
    page.get_by_label("More about this trip").click()
    page.get_by_role("button", name="Rename…").click()
    page.get_by_role("dialog").get_by_label("Name").fill("<img src=x onerror=alert(1)>")
    page.keyboard.press("Enter")
    expect(page.locator("#trip-title")).to_have_text("<img src=x onerror=alert(1)>")
    page.reload()
    expect(page.locator("#trip-title")).to_have_text("<img src=x onerror=alert(1)>")
    page.get_by_role("tab", name="Notes").click()
    expect(page.get_by_label("Notes about this trip")).to_have_value("<b>wet</b> road & roof box")


@pytest.mark.parametrize("form", ["KMZ", "CSV", "Parquet", "MAT", "GeoJSON"])
def test_a_trip_is_exported(page: Page, form: str) -> None:
    page.get_by_text("Export", exact=True).click()
    with page.expect_download() as download:
        page.locator("#export-items").get_by_role("link", name=form).click()
    path = download.value.path()
    assert path.stat().st_size > 1000
    if form == "KMZ":
        assert any(name.endswith(".kml") for name in ZipFile(path).namelist())


def test_without_webgl_the_track_is_a_plan(
    driver: Playwright, chromium: str, ponthy: str, uploaded: Uploaded, watch: Watch
) -> None:
    plain = driver.chromium.launch(
        executable_path=chromium, args=["--no-sandbox", "--disable-gpu", "--disable-3d-apis"]
    )
    try:
        page = _opened(plain, ponthy, f"/trips/{uploaded.trip_id}", watch)
        _ready(page)
        expect(page.locator("#track")).to_contain_text("East, m")
        before = page.evaluate(DOT)
        page.locator("#cursor-slider").fill("300")
        eventually(lambda: page.evaluate(DOT) != before, "the dot to follow")
    finally:
        plain.close()


def _opened(browser: Browser, ponthy: str, path: str, watch: Watch, **options: Any) -> Page:
    context = browser.new_context(base_url=ponthy, viewport={"width": 1440, "height": 900}, **options)
    watch.on(context)
    page = context.new_page()
    page.goto(path)
    return page


def test_a_trip_that_is_not_there_is_told_with_a_way_back(open_page: Opener, watch: Watch) -> None:
    watch.expect("404")
    page = open_page("/trips/00000000000000000000000000000000")
    expect(page.get_by_role("heading", level=1)).to_have_text("404 · Nothing is here")
    expect(page.get_by_role("link", name="To the overview", exact=True)).to_be_visible()
    page.get_by_role("link", name="To the trips").click()
    expect(page.get_by_role("heading", level=1)).to_have_text("Trips")


def test_a_trip_runs_again_with_another_filter(page: Page, uploaded: Uploaded) -> None:
    page.get_by_role("button", name="Run again with").click()
    page.get_by_label("Filter").select_option("sr-ekf")
    page.get_by_role("button", name="Run", exact=True).click()
    trip = f"trips/{uploaded.trip_id}"
    eventually(lambda: api(page, trip)["filter"] == "sr-ekf", "the other filter's result", seconds=180)
    assert api(page, trip)["provenance"]["filter"] == "sr-ekf"


def test_a_bad_tuning_file_is_answered_where_it_was_chosen(page: Page, watch: Watch, tmp_path: Path) -> None:
    watch.expect("422")
    page.get_by_role("button", name="Run again with").click()
    for text, said in (
        ('{"q_thurst": 1}', "q_thurst: no such entry in a tuning. Did you mean q_thrust?"),
        ("{q", "bad.json: this is not JSON"),
    ):
        (tmp_path / "bad.json").write_text(text)
        page.get_by_label("tuning file").set_input_files(tmp_path / "bad.json")
        page.get_by_role("button", name="Run", exact=True).click()
        expect(page.locator("#run-dialog").get_by_role("alert")).to_contain_text(said)
    page.get_by_role("button", name="Cancel").click()


def test_health_tells_of_each_sensor_and_its_figures_have_tables(page: Page) -> None:
    health = page.get_by_role("tabpanel", name="Observer health")
    expect(health.get_by_role("row", name=re.compile("Accelerometer, forward"))).to_be_visible()
    for title in (
        "Spread: NIS beside its band",
        "Coverage: inside one and two σ",
        "Whiteness: correlation of neighbours",
    ):
        card = health.locator("section.card", has=page.get_by_role("heading", name=title))
        expect(card.locator(".main-svg").first).to_be_visible()
        card.get_by_role("button", name="Show as table").click()
        expect(card.get_by_role("cell", name="Accelerometer, forward").first).to_be_visible()
