"""Formulas on the car page: chosen by keyboard, side by side, refused in words."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.support import Uploaded, Watch, api

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]


@pytest.fixture
def page(open_page: Opener, uploaded: Uploaded) -> Page:
    """Return the tab of a car whose map carries formulas."""
    opened = open_page(f"/cars/{uploaded.car_id}#fits")
    expect(opened.locator("#fits .fit").first).to_be_visible()
    return opened


def chosen(page: Page, group: str, name: str) -> None:
    page.get_by_role("group", name=group).get_by_label(name, exact=True).check()


def test_every_formula_has_contours_residuals_and_coefficients(page: Page, uploaded: Uploaded) -> None:
    told = api(page, f"cars/{uploaded.car_id}/maps/latest/fits?target=eta&degree=2")
    expect(page.locator("#fits .fit")).to_have_count(len(told["fits"]))
    expect(page.locator("#fits .fit .js-plotly-plot")).to_have_count(2 * len(told["fits"]))
    proposed = page.locator("#fits .fit", has_text="proposed")
    expect(proposed.get_by_role("heading")).to_have_text(told["best"])
    proposed.locator("summary").click()
    expect(proposed.get_by_role("row")).to_have_count(1 + len(next(o for o in told["fits"] if o["proposed"])["terms"]))
    proposed.get_by_role("button", name="Show as table").last.click()
    expect(proposed.locator(".figure").last).to_contain_text("Residual, points")


def test_fuel_power_has_a_willans_model_and_no_border(page: Page) -> None:
    page.get_by_role("group", name="Formula of").get_by_label("η", exact=True).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    expect(page.locator("#fits .fit h3", has_text="Willans")).to_be_visible()
    expect(page.get_by_role("heading", name="Fuel power over torque")).to_be_visible()
    expect(page.get_by_label("Border of no efficiency")).to_be_disabled()


def test_own_terms_are_fitted_and_a_wrong_one_is_named(page: Page, watch: Watch) -> None:
    watch.expect("422")
    chosen(page, "Highest power of one variable", "Own terms")
    expect(page.locator("#fits .fit h3")).to_have_count(1)
    expect(page.locator("#fits .fit h3")).to_have_text("chosen")
    terms = page.get_by_label("Own terms in ω")
    terms.fill("1, w, x")
    terms.press("Enter")
    expect(page.locator("#fits").get_by_role("alert")).to_contain_text("'x' is not a term")
    terms.fill("1, w, T")
    terms.press("Enter")
    expect(page.locator("#fits tbody tr").first).to_contain_text("chosen")


def test_a_car_without_a_map_is_told_so(open_page: Opener, watch: Watch) -> None:
    watch.expect("404")
    opened = open_page("/cars")
    car = opened.request.post("/api/v1/cars", data={"name": "No map"}).json()
    opened.goto(f"/cars/{car['id']}#fits")
    expect(opened.locator("#fits .empty")).to_contain_text("No efficiency map yet")
    opened.request.delete(f"/api/v1/cars/{car['id']}")
