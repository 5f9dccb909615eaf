"""The API describes itself: every route says what it does, what it answers, and how it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import schemathesis
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, Phase, given, settings

from app.batteries.schemas import CONFIG_EXAMPLE
from app.drives.schemas import ACCELERATE
from app.main import create_app
from app.settings import Settings
from app.storage.migrate import migrate

GENERATOR = "http://testserver"
BOUNDED = settings(
    max_examples=15,
    deadline=None,
    derandomize=True,
    database=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture
def description(client: TestClient) -> dict[str, Any]:
    answer = client.get("/openapi.json")
    assert answer.status_code == 200
    found: dict[str, Any] = answer.json()
    return found


def operations(description: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return [
        (f"{method.upper()} {path}", operation)
        for path, methods in description["paths"].items()
        for method, operation in methods.items()
    ]


def test_every_route_says_what_it_does_and_how_it_refuses(description: dict[str, Any]) -> None:
    for name, operation in operations(description):
        assert operation.get("description"), name
        for status in ("4XX", "422", "507"):
            content = operation["responses"][status]["content"]
            assert content == {
                "application/problem+json": {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}
            }, name


def test_every_shape_that_is_answered_has_an_example(description: dict[str, Any]) -> None:
    """Lists and other shapes that only hold shapes with examples need none of their own."""
    schemas = description["components"]["schemas"]
    answered = set(
        re.findall(r"#/components/schemas/(\w+)", json.dumps([o["responses"] for _, o in operations(description)]))
    )
    without = {
        name
        for name in answered
        if "example" not in schemas[name]
        and not any("#/components/schemas/" in json.dumps(shape) for shape in schemas[name]["properties"].values())
    }
    assert without == set()


@schemathesis.serializer("application/offset+octet-stream")
def as_bytes(_context: Any, value: Any) -> Any:
    """Let the generator send the bodies of tus."""
    return value if isinstance(value, bytes) else str(value).encode()


def known_rows(client: TestClient) -> dict[str, str]:
    """Return identifiers of things that exist, by the name of the path's parameter."""
    car = client.post("/api/v1/cars", json={}).json()["id"]
    data = b"t_s,speed_mps\n0,1\n1,2\n"
    sent = client.post("/api/v1/trips", params={"car_id": car, "filename": "a.csv"}, content=data).json()
    here = {"url": "http://localhost:9/", "events": ["trip.ready"]}
    webhook = client.post("/api/v1/webhooks", json=here).json()["id"]
    battery = client.post("/api/v1/batteries", json={"car_id": car, "config": CONFIG_EXAMPLE}).json()["id"]
    return {
        "car_id": car,
        "battery_id": battery,
        "drive_id": client.post("/api/v1/drives", json={"problem": ACCELERATE}).json()["id"],
        "upload_id": sent["upload"]["id"],
        "trip_id": sent["trip"]["id"],
        "job_id": sent["job"]["id"],
        "webhook_id": webhook,
        "delivery_id": client.post(f"/api/v1/webhooks/{webhook}/test").json()["id"],
    }


@pytest.mark.slow
def test_no_input_makes_it_fail(tmp_path: Path) -> None:
    """Generated requests to every route, about things that exist: whatever they say, the fault is theirs."""
    embedded = Settings(data_dir=tmp_path, public_url=GENERATOR)
    migrate(embedded)
    app = create_app(embedded)
    failed: list[str] = []
    asked: set[str] = set()
    with TestClient(app, base_url=GENERATOR) as client:
        known = known_rows(client)

        def ask(case: schemathesis.Case) -> None:
            case.path_parameters = {**(case.path_parameters or {}), **known}
            if "wait" in (case.query or {}):  # nobody works here, so it would be waited for in vain
                case.query["wait"] = "0"
            asked.add(f"{case.method} {case.path}")
            answer = case.call()
            if answer.status_code >= 500:
                failed.append(f"{answer.status_code} {case.as_curl_command()}")

        for result in schemathesis.openapi.from_asgi("/openapi.json", app).get_all_operations():
            operation = result.ok()
            if not operation.path.endswith("/events"):  # those never end
                BOUNDED(given(operation.as_strategy())(ask))()
    assert failed == []
    assert len(asked) > 45
