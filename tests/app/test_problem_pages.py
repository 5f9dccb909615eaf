"""A browser gets a page that says what is wrong; a program gets problem+json from the same address."""

from __future__ import annotations

import re

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.exc import OperationalError

from app.main import create_app
from app.settings import Settings
from tests.services import BASE_URL

BROWSER = {"Accept": "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"}
PROBLEM = "application/problem+json"
NOBODY = "0" * 32


@pytest.mark.parametrize(
    ("path", "told", "way"),
    [
        ("/nothing", "Nothing is at /nothing.", 'href="/"'),
        (f"/trips/{NOBODY}", f"There is no trip &#39;{NOBODY}&#39; in this fleet.", 'href="/trips"'),
        (f"/cars/{NOBODY}", f"There is no car &#39;{NOBODY}&#39; in this fleet.", 'href="/cars"'),
        (f"/cars/{NOBODY}/maps/1", "There is no car", 'href="/cars"'),
        ("/cars/7", "Nothing is at /cars/7.", 'href="/cars"'),
        ("/trips/%00", "Nothing is at /trips/", 'href="/trips"'),
        (f"/jobs/{NOBODY}", f"Nothing is at /jobs/{NOBODY}.", 'href="/jobs"'),
        ("/<script>alert(1)</script>", "Nothing is at /&lt;script&gt;alert(1)&lt;/script&gt;.", 'href="/"'),
        ("/apiary", "Nothing is at /apiary.", 'href="/"'),
    ],
)
def test_a_browser_is_told_what_is_not_there_and_where_to_go(
    client: TestClient, path: str, told: str, way: str
) -> None:
    answer = client.get(path, headers=BROWSER)
    assert answer.status_code == 404
    assert answer.headers["Content-Type"].startswith("text/html")
    assert answer.headers["Cache-Control"] == "no-cache"
    content = answer.text.split("<main", 1)[1]
    assert told in content
    assert way in content
    assert 'aria-label="Main"' in answer.text, "the frame of every page is around it"


def test_a_version_of_a_map_that_is_not_there_is_told(client: TestClient) -> None:
    car = client.post("/api/v1/cars", json={}).json()["id"]
    assert client.get(f"/cars/{car}", headers=BROWSER).status_code == 200
    for version in ("1", "x"):
        answer = client.get(f"/cars/{car}/maps/{version}", headers=BROWSER)
        assert answer.status_code == 404
        assert f"There is no map version &#39;{version}&#39;" in answer.text


@pytest.mark.parametrize("accept", ["*/*", "application/json", ""])
@pytest.mark.parametrize("path", ["/nothing", f"/trips/{NOBODY}", "/cars/7"])
def test_a_program_gets_problem_json(client: TestClient, path: str, accept: str) -> None:
    answer = client.get(path, headers={"Accept": accept})
    assert (answer.status_code // 100, answer.headers["Content-Type"]) == (4, PROBLEM)


@pytest.mark.parametrize("path", ["/api/v1/nothing", f"/api/v1/trips/{NOBODY}", "/api/v1/cars/7", "/api", "/api/"])
def test_the_api_answers_a_browser_with_problem_json_too(client: TestClient, path: str) -> None:
    answer = client.get(path, headers=BROWSER)
    assert (answer.status_code // 100, answer.headers["Content-Type"]) == (4, PROBLEM)


def test_a_fault_of_ours_is_a_page_with_the_request_id(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("the secret plan")

    monkeypatch.setattr("app.trips.service.row", fail)
    answer = client.get(f"/trips/{NOBODY}", headers=BROWSER)
    assert answer.status_code == 500
    assert "secret plan" not in answer.text
    assert f"<code>{answer.headers['X-Request-Id']}</code>" in answer.text
    assert '<a class="btn primary" href="">Try again</a>' in answer.text


def test_a_busy_database_is_a_page_that_says_when_to_try_again(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OperationalError("", {}, Exception("database is locked"))

    monkeypatch.setattr("app.cars.service.get", fail)
    answer = client.get(f"/cars/{NOBODY}", headers=BROWSER)
    assert (answer.status_code, answer.headers["Retry-After"]) == (503, "5")
    assert "Try again in a few seconds." in answer.text


def test_a_foreign_name_is_told_without_links_that_would_lead_nowhere(client: TestClient) -> None:
    answer = client.get("/", headers={**BROWSER, "Host": "evil.example"})
    assert answer.status_code == 421
    assert "answers to localhost only" in answer.text
    assert not re.search(r'<a\b[^>]*href="/', answer.text)


def test_a_problem_is_told_even_when_no_page_can_be_made(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("the templates are gone")

    monkeypatch.setattr("app.problem_pages.render", fail)
    answer = client.get("/nothing", headers=BROWSER)
    assert (answer.status_code, answer.headers["Content-Type"]) == (404, PROBLEM)


def test_whoever_has_yet_to_sign_in_learns_nothing_of_what_is_there(settings: Settings) -> None:
    guarded = settings.model_copy(update={"auth": True})
    with TestClient(create_app(guarded), base_url=BASE_URL) as client:
        assert client.get(f"/trips/{NOBODY}", headers=BROWSER).status_code == 200
        assert client.get(f"/cars/{NOBODY}", headers=BROWSER).status_code == 200
