"""The tab Compare: two maps, and a table laid over the map whose level is corrected only after a word."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.support import Uploaded, api

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]


def test_maps_are_compared_and_a_table_is_laid_over(open_page: Opener, uploaded: Uploaded) -> None:
    put_back_the_maps_car_file(open_page("/cars"), uploaded.car_id)
    page = open_page(f"/cars/{uploaded.car_id}#compare")
    revision = api(page, f"cars/{uploaded.car_id}")["config_revision"]
    expect(page.locator("#compare")).to_contain_text("known in both differs by more than chance explains")
    page.get_by_label("Periods", exact=True).check(force=True)
    page.locator("#compare-first-from").fill("2001-01-01")
    page.locator("#compare-second-to").fill("2101-01-01")
    expect(page.locator("#compare")).to_contain_text("Second: until 1 Jan 2101")
    page.get_by_text("Add a table").click()
    table = {"name": "bench.csv", "mimeType": "text/csv", "buffer": bench(page, uploaded.car_id)}
    page.locator("#reference-file").set_input_files(files=[table])
    page.locator("#reference-name").fill("Bench of May")
    page.get_by_role("button", name="Add the table").click()
    expect(page.locator("#compare")).to_contain_text("Map over table")
    page.get_by_label("Difference", exact=True).check(force=True)
    expect(page.locator("#compare")).to_contain_text("Map less table, points")
    page.get_by_role("button", name="Correct the level").click()
    expect(page.get_by_role("dialog")).to_contain_text("This is right only if it is the fuel that is counted wrongly")
    page.get_by_role("button", name="Cancel").click()
    assert api(page, f"cars/{uploaded.car_id}")["config_revision"] == revision


def put_back_the_maps_car_file(page: Page, car_id: str) -> None:
    """Undo what other tests saved since the newest map: its level is corrected with the file it was made with only."""
    made_with = api(page, f"cars/{car_id}/maps/latest")["provenance"]["config_sha256"]
    revisions = api(page, f"cars/{car_id}/config/revisions")["items"]
    number = next(one["number"] for one in revisions if one["sha256"] == made_with)
    assert page.request.post(f"/api/v1/cars/{car_id}/config/revisions/{number}/restore").ok


def bench(page: Page, car_id: str) -> bytes:
    """The car's own trusted cells, 5 % better, as a dynamometer would write them."""
    cells = api(page, f"cars/{car_id}/maps/latest")["cells"]
    rows = [f"{c['rpm']},{c['nm']},{1.05 * c['efficiency']:.4f}" for c in cells if c["efficiency"]]
    return "\n".join(["rpm,nm,efficiency", *rows]).encode()
