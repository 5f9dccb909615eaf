"""The whole path in a browser: an empty Ponthy, a car from its XML, a trip dropped, its job, its map."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect

from tests.e2e.support import Drive, Uploaded, Watch, api, eventually

pytestmark = pytest.mark.e2e
Opener = Callable[..., Page]


def test_an_uploaded_trip_has_gone_through_its_stages(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page("/jobs")
    job = page.locator("article.job", has_text="trip.dat").first
    expect(job.locator(".verdict").first).to_contain_text("done")
    expect(job.locator("li.succeeded")).to_have_count(6)
    job.get_by_text("Log").click()
    expect(job.locator(".log")).to_contain_text("Job succeeded")
    expect(page.locator("#connection")).to_have_text("Live")


def test_the_overview_shows_the_car_and_its_latest_trip(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page("/")
    expect(page.locator("#first")).to_be_hidden()
    expect(page.locator(".car-card strong").first).to_contain_text("%")
    expect(page.locator("#recent-trips tbody tr")).not_to_have_count(0)


def test_the_elevation_table_that_came_along_is_listed(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page("/settings")
    expect(page.locator("#roads")).to_contain_text("elevation.csv")


def test_a_new_car_is_made_from_its_xml_on_the_cars_page(open_page: Opener, drive: Drive) -> None:
    page = open_page("/cars")
    page.get_by_role("button", name="New car").click()
    dialog = page.get_by_role("dialog")
    page.set_input_files("#new-car-file", drive.car_xml)
    dialog.get_by_label("Name").fill("Second roadster")
    dialog.get_by_role("button", name="Add car").click()
    expect(page.locator("#car-name")).to_have_text("Second roadster")
    expect(page.locator("#map-note")).to_contain_text("No efficiency map yet")


def test_a_file_that_is_no_car_is_refused_with_line_and_reason(open_page: Opener, watch: Watch) -> None:
    watch.expect(r"422")
    page = open_page("/cars")
    page.get_by_role("button", name="New car").click()
    page.set_input_files(
        "#new-car-file",
        {
            "name": "car.xml",
            "mimeType": "text/xml",
            "buffer": b"<ponthy_config>\n<mass wet='heavy'/>\n</ponthy_config>",
        },
    )
    page.get_by_role("dialog").get_by_role("button", name="Add car").click()
    expect(page.locator("#new-car-problem")).to_contain_text("line 2")
    expect(page.locator("#new-car-problem")).to_contain_text("heavy")


def test_the_same_file_again_is_told_kindly(open_page: Opener, drive: Drive, uploaded: Uploaded) -> None:
    page = open_page(f"/upload?car={uploaded.car_id}")
    page.set_input_files("#files", drive.image)
    page.get_by_role("button", name="Send", exact=True).click()
    expect(page.locator("#queue-rows")).to_contain_text("already")
    expect(page.get_by_role("link", name="Open the trip")).to_have_attribute("href", f"/trips/{uploaded.trip_id}")


def test_a_mapping_goes_along_with_a_foreign_table(open_page: Opener, uploaded: Uploaded) -> None:
    rows = "".join(f"{100 * k},{72}\n" for k in range(3000))
    mapping = {"time": {"column": "ms", "scale": 0.001}, "signals": {"kmh": {"signal": "speed_mps", "scale": 1 / 3.6}}}
    page = open_page(f"/upload?car={uploaded.car_id}")
    page.set_input_files(
        "#files",
        [
            {"name": "foreign.csv", "mimeType": "text/csv", "buffer": f"ms,kmh\n{rows}".encode()},
            {"name": "mapping.json", "mimeType": "application/json", "buffer": json.dumps(mapping).encode()},
        ],
    )
    page.get_by_role("button", name="Send 2 files").click()
    link = page.get_by_role("link", name="Open the trip")
    link.wait_for(timeout=60_000)
    path = str(link.get_attribute("href")).removeprefix("/")
    trip = eventually(lambda: (found := api(page, path))["state"] == "ready" and found, "the foreign trip")
    assert trip["distance_m"] == pytest.approx(20.0 * 299.9, rel=0.01)


def test_a_file_that_is_no_trip_fails_with_a_reason(open_page: Opener, uploaded: Uploaded, watch: Watch) -> None:
    page = open_page(f"/upload?car={uploaded.car_id}")
    page.set_input_files("#files", {"name": "holiday.dat", "mimeType": "", "buffer": b"\0" * 40_000})
    page.get_by_role("button", name="Send", exact=True).click()
    expect(page.locator("#queue-rows .problem")).to_be_visible(timeout=60_000)


def test_an_upload_goes_on_after_a_reload_where_it_stopped(
    open_page: Opener, drive: Drive, uploaded: Uploaded, tmp_path: Path, watch: Watch
) -> None:
    image = tmp_path / "again.dat"
    image.write_bytes(drive.image.read_bytes() + b"\0" * 3_000_000)
    page = open_page(f"/upload?car={uploaded.car_id}")
    lost: list[int] = []

    def only_the_first_chunk_arrives(route: Route) -> None:
        offset = int(route.request.headers.get("upload-offset", "0"))
        if route.request.method == "PATCH" and offset > 0:
            lost.append(offset)
            route.abort()
        else:
            route.continue_()

    watch.expect("ERR_FAILED")
    page.route("**/api/v1/uploads/*", only_the_first_chunk_arrives)
    page.set_input_files("#files", image)
    page.get_by_role("button", name="Send", exact=True).click()
    expect(page.locator("#queue-rows")).to_contain_text("No connection; goes on by itself")
    page.get_by_role("button", name="Pause").click()
    expect(page.locator("#queue-rows")).to_contain_text("Paused at")
    page.unroute_all(behavior="wait")

    page.reload()
    expect(page.locator("#unfinished-rows")).to_contain_text("again.dat")
    resumed: list[int] = []
    page.on("request", lambda r: resumed.append(int(r.headers["upload-offset"])) if r.method == "PATCH" else None)
    page.set_input_files("#files", image)
    expect(page.locator("#queue-rows")).to_contain_text("goes on where it stopped")
    page.get_by_role("button", name="Send", exact=True).click()
    expect(page.get_by_role("link", name="Open the trip")).to_be_visible(timeout=60_000)
    assert resumed[0] == lost[0] > 0
    assert page.evaluate("() => localStorage.getItem('ponthy-uploads')") == "{}"


def test_a_job_is_watched_live_cancelled_and_tried_again(
    open_page: Opener, long_drive: Drive, uploaded: Uploaded
) -> None:
    page = open_page("/jobs")
    expect(page.locator("#connection")).to_have_text("Live")
    page.request.post(
        f"/api/v1/trips?car_id={uploaded.car_id}&filename=long.dat", data=long_drive.image.read_bytes(), timeout=60_000
    )
    job = page.locator("article.job", has_text="long.dat")
    job.get_by_role("button", name="Cancel").click()
    expect(job.locator(".verdict").first).to_contain_text("cancelled", timeout=60_000)
    job.get_by_role("button", name="Try again").click()
    expect(job.locator(".verdict").first).to_contain_text("done", timeout=240_000)
    expect(job.locator("li.succeeded")).to_have_count(6)


def test_a_trip_runs_again_without_a_sensor_and_with_all(open_page: Opener, uploaded: Uploaded) -> None:
    page = open_page(f"/trips/{uploaded.trip_id}")
    for wanted in (["gps"], []):
        page.get_by_role("button", name="Run again with…").click()
        dialog = page.get_by_role("dialog")
        dialog.get_by_label("Satellite positions").set_checked(not wanted)
        dialog.get_by_role("button", name="Run", exact=True).click()
        expect(page.locator("#trip-job .job")).to_be_visible()
        eventually(lambda: _without(page, uploaded.trip_id) == wanted, "the trip to be ready again")  # noqa: B023 - asked within the loop
        page.reload()
    expect(page.locator(".cursor-dot")).to_be_visible()


def _without(page: Page, trip_id: str) -> list[str] | None:
    trip = api(page, f"trips/{trip_id}")
    return trip["provenance"]["without"] if trip["state"] == "ready" else None
