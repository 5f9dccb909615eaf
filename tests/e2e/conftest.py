"""A running Ponthy, a simulated drive, and a browser that notes everything that is not as it should be."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, Playwright, sync_playwright

from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation
from tests.e2e.support import PASSWORD, PERSON, ROOT, Drive, Uploaded, Watch, api, eventually, running_ponthy

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
SOFTWARE_GL = ["--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="session")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Drive:
    """A quarter of an hour with the virtual car."""
    return _written(tmp_path_factory.mktemp("drive"), Simulation(duration_s=900.0, seed=21, route="mixed"))


@pytest.fixture(scope="session")
def long_drive(tmp_path_factory: pytest.TempPathFactory) -> Drive:
    """An hour and a half with the virtual car, which takes a worker long enough to be stopped."""
    return _written(tmp_path_factory.mktemp("long-drive"), Simulation(duration_s=5400.0, seed=22, route="motorway"))


def _written(folder: Path, simulation: Simulation) -> Drive:
    trip = simulate(simulation)
    files = Drive(folder / "trip.dat", folder / "car.xml", folder / "elevation.csv")
    files.image.write_bytes(trip.image)
    files.car_xml.write_bytes(trip.car_xml)
    files.elevation_csv.write_bytes(trip.elevation_csv)
    return files


@pytest.fixture(scope="session")
def ponthy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a Ponthy that was started as a person starts it, on a free port and an empty folder."""
    with running_ponthy(tmp_path_factory.mktemp("ponthy")) as address:
        yield address


@pytest.fixture(scope="session")
def guarded_ponthy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a Ponthy that asks for a login, and lets one person in."""
    data = tmp_path_factory.mktemp("guarded")
    add = [sys.executable, "-m", "app.cli", "user", "add", PERSON, "--password-stdin", "--data", str(data)]
    subprocess.run(add, cwd=ROOT, input=PASSWORD, text=True, check=True, capture_output=True)
    with running_ponthy(data, PONTHY_AUTH="true") as address:
        yield address


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of a browser on this machine."""
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        reason = f"no browser on this machine (looked for {', '.join(BROWSERS)})"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    return found


@pytest.fixture(scope="session")
def driver() -> Iterator[Playwright]:
    """Playwright, once for all tests."""
    with sync_playwright() as playwright:
        yield playwright


@pytest.fixture(scope="session")
def browser(driver: Playwright, chromium: str) -> Iterator[Browser]:
    """A browser that draws 3-D in software."""
    started = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox", *SOFTWARE_GL])
    yield started
    started.close()


@pytest.fixture
def watch(ponthy: str) -> Iterator[Watch]:
    """Notes on everything unexpected; the test fails at its end when there is any."""
    noting = Watch(urlsplit(ponthy).netloc)
    yield noting
    assert noting.unexpected() == []


@pytest.fixture
def open_page(browser: Browser, ponthy: str, watch: Watch) -> Iterator[Callable[..., Page]]:
    """Return a function that opens a path of Ponthy in a fresh browser session."""
    contexts: list[BrowserContext] = []

    def open_path(path: str = "/", **options: Any) -> Page:
        context = browser.new_context(base_url=ponthy, **{"viewport": {"width": 1440, "height": 900}, **options})
        contexts.append(context)
        watch.on(context)
        page = context.new_page()
        page.set_default_timeout(15_000)
        page.goto(path)
        return page

    yield open_path
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def uploaded(browser: Browser, ponthy: str, drive: Drive) -> Uploaded:
    """Bring a car and a trip in by the upload page, and wait until the trip is ready."""
    context = browser.new_context(base_url=ponthy)
    page = context.new_page()
    page.goto("/upload")
    page.set_input_files("#files", [drive.car_xml, drive.image, drive.elevation_csv])
    page.get_by_role("button", name="Send 3 files").click()
    page.get_by_role("link", name="Open the trip").wait_for(timeout=60_000)
    trip_id = page.get_by_role("link", name="Open the trip").get_attribute("href").rsplit("/", 1)[1]
    trip = eventually(lambda: _settled(api(page, f"trips/{trip_id}")), "the trip to be ready", 240)
    eventually(lambda: api(page, f"jobs/{trip['job_id']}")["state"] == "succeeded", "its job to be over", 240)
    context.close()
    return Uploaded(trip["car_id"], trip_id)


def _settled(trip: dict[str, Any]) -> dict[str, Any] | None:
    assert trip["state"] != "failed", trip["problem"]
    return trip if trip["state"] == "ready" else None
