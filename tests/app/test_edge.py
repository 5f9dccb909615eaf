"""What happens to every request: who may ask from where, how faults are answered, what is logged."""

from __future__ import annotations

import errno
import io
import json
import logging
from collections.abc import Iterator
from typing import Any

import pytest
import structlog
from fastapi.testclient import TestClient
from sqlalchemy.exc import DataError, IntegrityError, OperationalError

from app.main import create_app
from app.observability import configure_logging
from app.science.errors import DecodeError
from app.settings import Settings
from app.storage.resources import Resources
from tests.services import BASE_URL

PROBLEM = "application/problem+json"


@pytest.mark.parametrize("host", ["127.0.0.1:8321", "localhost", "localhost:1", "[::1]:8321", "127.0.0.2"])
def test_this_machine_answers_to_its_own_names(client: TestClient, host: str) -> None:
    assert client.get("/health/live", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "evil.example:8321", "", "[", "10.0.0.1"])
def test_a_rebound_name_is_refused(client: TestClient, host: str) -> None:
    answer = client.get("/api/v1/cars", headers={"Host": host})
    assert (answer.status_code, answer.json()["code"]) == (421, "misdirected-request")


def test_a_public_name_is_answered_to(settings: Settings) -> None:
    named = settings.model_copy(update={"public_url": "https://ponthy.example"})
    with TestClient(create_app(named), base_url="https://ponthy.example") as client:
        answer = client.post("/api/v1/cars", headers={"Origin": "https://ponthy.example"})
    assert answer.status_code == 201
    assert answer.headers["Strict-Transport-Security"]


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:9999"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "cross-site", "Origin": "https://evil.example"},
    ],
)
def test_another_sites_page_changes_nothing(client: TestClient, headers: dict[str, str]) -> None:
    answer = client.post("/api/v1/cars", json={}, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (403, "cross-origin-request")
    assert client.get("/api/v1/cars", headers=headers).json()["items"] == []


@pytest.mark.parametrize(
    "headers",
    [{}, {"Origin": BASE_URL}, {"Sec-Fetch-Site": "same-origin"}, {"Sec-Fetch-Site": "none"}],
)
def test_our_own_pages_and_programs_may_change_things(client: TestClient, headers: dict[str, str]) -> None:
    assert client.post("/api/v1/cars", json={}, headers=headers).status_code == 201


@pytest.mark.parametrize("path", ["/", "/api/v1/cars", "/nothing", "/health/live"])
def test_every_answer_has_the_security_headers(client: TestClient, path: str) -> None:
    headers = client.get(path).headers
    policy = dict(part.strip().split(" ", 1) for part in headers["Content-Security-Policy"].split(";"))
    assert policy["script-src"] == policy["default-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert len(headers["X-Request-Id"]) == 32


def test_a_tile_source_is_let_in(settings: Settings) -> None:
    tiled = settings.model_copy(update={"tiles_url": "https://{s}.tiles.example/{z}/{x}/{y}.png"})
    with TestClient(create_app(tiled), base_url=BASE_URL) as client:
        policy = client.get("/").headers["Content-Security-Policy"]
        assert "img-src 'self' https://*.tiles.example data: blob:" in policy
        assert "connect-src 'self' https://*.tiles.example" in policy
        assert client.get("/api/v1/session").json()["tiles"]["url"].startswith("https://{s}.tiles.example/")


@pytest.mark.parametrize(
    ("method", "path", "status", "code"),
    [
        ("GET", "/api/v1/nothing", 404, "not-found"),
        ("GET", f"/api/v1/cars/{'0' * 32}", 404, "not-found"),
        ("GET", "/api/v1/cars/1", 422, "invalid-request"),
        ("PUT", "/api/v1/cars", 405, "method-not-allowed"),
        ("GET", "/api/v1/cars?limit=1000", 422, "invalid-request"),
        ("GET", "/api/v1/cars?cursor=x", 422, "bad-cursor"),
        ("GET", "/api/v1/trips/%00", 422, "invalid-request"),
    ],
)
def test_faults_are_answered_as_problems(client: TestClient, method: str, path: str, status: int, code: str) -> None:
    answer = client.request(method, path)
    problem = answer.json()
    assert (answer.status_code, problem["code"]) == (status, code)
    assert answer.headers["Content-Type"] == PROBLEM
    assert problem["status"] == status
    assert problem["type"] == f"urn:ponthy:problem:{code}"
    assert problem["detail"]
    assert problem["instance"]


@pytest.mark.parametrize(
    "body",
    [
        b"{",
        b"[]",
        b'"x"',
        b"\xff\xfe",
        b'{"name": NaN}',
        b"[" * 100_000,
        b'{"name": "\\u0000"}',
        b'{"name": "\\ud800"}',
    ],
)
def test_a_bad_body_is_our_callers_fault(client: TestClient, body: bytes) -> None:
    for path in ("/api/v1/cars", "/api/v1/tokens"):
        answer = client.post(path, content=body, headers={"Content-Type": "application/json"})
        assert 400 <= answer.status_code < 500
        assert answer.headers["Content-Type"] == PROBLEM


@pytest.mark.parametrize("announced", [True, False])
def test_an_endless_body_is_cut_off(settings: Settings, announced: bool) -> None:
    small = settings.model_copy(update={"max_body_bytes": 10_000})
    body = b'{"name": "' + b"x" * 20_000 + b'"}'
    with TestClient(create_app(small), base_url=BASE_URL) as client:
        sent = body if announced else iter([body[:9000], body[9000:]])
        answer = client.post("/api/v1/tokens", content=sent, headers={"Content-Type": "application/json"})
    assert (answer.status_code, answer.headers["Content-Type"]) == (413, PROBLEM)


def test_a_fault_of_ours_tells_nothing_but_its_id(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("the secret plan")

    monkeypatch.setattr("app.cars.service.page", fail)
    answer = client.get("/api/v1/cars")
    assert (answer.status_code, answer.json()["code"]) == (500, "internal-error")
    assert "secret plan" not in answer.text
    assert answer.headers["X-Request-Id"]


@pytest.mark.parametrize(
    ("fault", "status", "code"),
    [
        (OperationalError("", {}, Exception("database is locked")), 503, "database-busy"),
        (OperationalError("", {}, Exception("database or disk is full")), 507, "storage-full"),
        (IntegrityError("", {}, Exception("FOREIGN KEY constraint failed")), 409, "changed-meanwhile"),
        (DataError("", {}, Exception("value too long")), 422, "unstorable-value"),
        (OSError(errno.ENOSPC, "No space left on device"), 507, "storage-full"),
        (OSError(errno.EIO, "Input/output error"), 500, "internal-error"),
        (DecodeError("No packet.", 7), 422, "undecodable-image"),
    ],
)
def test_faults_below_are_told_apart(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, fault: Exception, status: int, code: str
) -> None:
    def fail(*_: object) -> None:
        raise fault

    monkeypatch.setattr("app.cars.service.page", fail)
    answer = client.get("/api/v1/cars")
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_a_request_id_is_taken_over_when_it_is_one(client: TestClient) -> None:
    assert client.get("/health/live", headers={"X-Request-Id": "abcd-1234"}).headers["X-Request-Id"] == "abcd-1234"
    assert client.get("/health/live", headers={"X-Request-Id": "a b\x01"}).headers["X-Request-Id"] != "a b\x01"


@pytest.fixture
def log(settings: Settings) -> Iterator[io.StringIO]:
    """Log as a server does, into a text."""
    root = logging.getLogger()
    before, level = root.handlers[:], root.level
    configure_logging(settings.model_copy(update={"log_json": True, "log_level": "debug"}))
    text = io.StringIO()
    for handler in root.handlers:
        assert isinstance(handler, logging.StreamHandler)
        handler.setStream(text)
    yield text
    root.handlers[:] = before
    root.setLevel(level)
    structlog.reset_defaults()


def lines(log: io.StringIO) -> list[dict[str, Any]]:
    return [json.loads(line) for line in log.getvalue().splitlines()]


def test_requests_are_logged_with_their_id_and_without_secrets(log: io.StringIO, client: TestClient) -> None:
    token = client.post("/api/v1/tokens", json={"name": "x"}).json()["token"]
    log.seek(0)
    log.truncate()
    headers = {"Authorization": f"Bearer {token}", "X-Request-Id": "0123456789"}
    client.get("/api/v1/cars?cursor=hidden", headers=headers)
    client.post("/api/v1/session", json={"email": "ada@example.org", "password": "a secret password"})
    (entry,) = [line for line in lines(log) if line.get("request_id") == "0123456789"]
    assert (entry["method"], entry["path"], entry["status"]) == ("GET", "/api/v1/cars", 422)
    assert entry["fleet_id"]
    ours = "\n".join(json.dumps(line) for line in lines(log) if "HTTP Request" not in line["event"])
    for secret in (token, "a secret password", "hidden"):
        assert secret not in ours


def test_secrets_are_blotted_out_wherever_they_stand(log: io.StringIO) -> None:
    values = {"password": "hunter2", "detail": "ponthy_0123abcd_SeCret"}
    structlog.get_logger("test").info("connected to postgresql://ponthy:hunter2@db/ponthy", **values)
    try:
        raise ValueError("redis://:hunter2@cache refused ponthy_0123abcd_SeCret")
    except ValueError:
        logging.getLogger("library").exception("failed")
    assert "hunter2" not in log.getvalue()
    assert "SeCret" not in log.getvalue()
    assert "postgresql://ponthy:•••@db" in lines(log)[0]["event"]


def test_it_says_that_it_is_alive_and_ready(client: TestClient) -> None:
    assert client.get("/health/live").json() == {"status": "alive"}
    answer = client.get("/health/ready")
    assert answer.status_code == 200
    assert answer.json() == {"ready": True, "parts": {"database": True, "files": True, "queue": True}}


def test_it_says_what_is_not_ready(client: TestClient, resources: Resources, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: object) -> None:
        raise ConnectionError("redis://:hunter2@cache is down")

    monkeypatch.setattr("app.storage.queue.Queue.check", fail)
    answer = client.get("/health/ready")
    assert answer.status_code == 503
    assert answer.json() == {"ready": False, "parts": {"database": True, "files": True, "queue": False}}


def test_metrics_count_routes_and_name_nobody(client: TestClient) -> None:
    car = client.post("/api/v1/cars", json={"name": "Grey"}).json()["id"]
    client.get(f"/api/v1/cars/{car}")
    text = client.get("/metrics").text
    assert 'ponthy_requests_total{method="GET",route="/api/v1/cars/{car_id}",status="200"} 1.0' in text
    assert car not in text
    assert "Grey" not in text


def test_metrics_off_loopback_need_their_token(settings: Settings) -> None:
    guarded = settings.model_copy(update={"auth": True})
    with TestClient(create_app(guarded), base_url="https://ponthy.example") as client:
        assert client.get("/metrics").status_code == 401
        assert client.get("/metrics", headers={"Authorization": "Bearer "}).status_code == 401
    configured = Settings(**{**settings.model_dump(), "auth": True, "metrics_token": "m" * 20})
    with TestClient(create_app(configured), base_url="https://ponthy.example") as client:
        assert client.get("/metrics", headers={"Authorization": "Bearer wrong"}).status_code == 401
        assert client.get("/metrics", headers={"Authorization": f"Bearer {'m' * 20}"}).status_code == 200
