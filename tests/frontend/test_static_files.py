"""Static files: addresses that change with the content, kept for ever, and never a way out of the folder."""

from __future__ import annotations

import gzip
import re

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from app import pages
from app.accounts import pages as account_pages
from app.batteries import pages as battery_pages
from app.cars import pages as car_pages
from app.drives import pages as drive_pages
from app.edge import page_session
from app.jobs import pages as job_pages
from app.maps import pages as map_pages
from app.static_files import STATIC_DIR, asset_url, plotly_url, static_version
from app.trips import pages as trip_pages
from app.uploads import pages as upload_pages

ONE = "1" * 32
PAGES = ["/", "/cars", f"/cars/{ONE}", f"/cars/{ONE}/maps/3", "/trips", f"/trips/{ONE}", "/upload", "/jobs"]
PAGES += ["/batteries", f"/batteries/{ONE}"]
PAGES += ["/drives", "/drives/new", "/drives/compare", f"/drives/{ONE}", "/settings", "/login"]


@pytest.fixture(scope="module")
def client() -> TestClient:
    app = FastAPI()
    slices = (battery_pages, car_pages, drive_pages, job_pages, map_pages, trip_pages, upload_pages)
    for module in (pages, account_pages, *slices):
        app.include_router(module.router)
    app.dependency_overrides[page_session] = lambda: None  # nobody is signed in
    return TestClient(app)


@pytest.mark.parametrize("path", PAGES)
def test_all_that_a_page_loads_is_there_and_kept_for_ever(client: TestClient, path: str) -> None:
    page = client.get(path)
    assert page.status_code == 200
    assert page.headers["cache-control"] == "no-cache"
    loaded = re.findall(r'(?:src|href)="(/static/[^"]+)"', page.text)
    assert len(loaded) >= 8
    for address in loaded:
        answer = client.get(address)
        assert answer.status_code == 200, address
        assert "immutable" in answer.headers["cache-control"]


def test_files_of_this_build_are_those_of_the_folder(client: TestClient) -> None:
    for path in ("css/base.css", "js/core/api.js", "img/mark.svg"):
        now, another = client.get(asset_url(path)), client.get(f"/static/000000000000/{path}")
        assert now.content == another.content == (STATIC_DIR / path).read_bytes()
        assert now.headers["content-type"] == another.headers["content-type"]


def test_every_import_of_every_module_exists() -> None:
    for module in STATIC_DIR.glob("js/**/*.js"):
        for target in re.findall(r'(?:from|import) "(\.[^"]+)"', module.read_text()):
            assert (module.parent / target).is_file(), f"{module.name} imports {target}"


def test_a_file_of_another_build_is_served_but_not_kept(client: TestClient) -> None:
    answer = client.get("/static/000000000000/css/base.css")
    assert answer.status_code == 200
    assert answer.headers["cache-control"] == "no-cache"


@pytest.mark.parametrize(
    "path", ["..%2f..%2fpyproject.toml", "%2e%2e/%2e%2e/pyproject.toml", "css/none.css", "css", "a%00b"]
)
def test_nothing_outside_the_folder_is_served(client: TestClient, path: str) -> None:
    assert client.get(f"/static/{static_version()}/{path}").status_code in (404, 405)


def test_plotly_is_sent_compressed_and_only_once(client: TestClient) -> None:
    url = plotly_url()
    with client.stream("GET", url, headers={"Accept-Encoding": "gzip"}) as answer:
        packed = b"".join(answer.iter_raw())
    plain = client.get(url, headers={"Accept-Encoding": "identity"})
    assert gzip.decompress(packed) == plain.content
    assert plain.content.startswith(b"/**")
    assert b"plotly.js" in plain.content[:200]
    assert len(packed) < len(plain.content) / 2
    again = client.get(url, headers={"If-None-Match": plain.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_an_identifier_in_the_address_cannot_break_out_of_its_attribute(client: TestClient) -> None:
    page = client.get(f'/cars/{ONE}/maps/"><script>alert(1)<').text
    assert "<script>alert" not in page


def test_asset_addresses_carry_the_hash_of_the_folder() -> None:
    assert re.fullmatch(r"/static/[0-9a-f]{12}/css/base\.css", asset_url("css/base.css"))
