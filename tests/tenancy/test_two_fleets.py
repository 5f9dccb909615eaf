"""Two fleets in one service: on no route does one see, change or guess anything of the other's."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
from fastapi.routing import APIRoute
from fastapi.testclient import TestClient

from app.accounts import service as accounts
from app.batteries.models import BatteryEstimate
from app.batteries.schemas import CONFIG_EXAMPLE as BATTERY
from app.drives.schemas import ACCELERATE
from app.health.models import Alert
from app.main import create_app
from app.maps.models import MapVersion
from app.settings import Settings
from app.storage.base import new_id, now
from app.storage.resources import Resources
from tests.uploads.conftest import Sender, signals_table

URL = "https://ponthy.example"
PASSWORD = "correct horse battery"  # noqa: S105 - of a made-up person
NEVER_ENDS = {"/api/v1/jobs/events"}
BODIES: dict[str, dict[str, Any]] = {
    "PATCH /api/v1/cars/{car_id}": {"json": {"name": "mine now"}},
    "PUT /api/v1/cars/{car_id}/config": {"content": b"<ponthy_config/>"},
    "PUT /api/v1/cars/{car_id}/config/form": {"json": {"values": {}}},
    "POST /api/v1/cars/{car_id}/calibration/apply": {"json": {"names": ["mounting"]}},
    "PATCH /api/v1/webhooks/{webhook_id}": {"json": {"description": "mine now"}},
    "POST /api/v1/cars/{car_id}/health/usual": {"json": {}},
    "GET /api/v1/cars/{car_id}/maps/compare": {"params": {"first": "1"}},
    "GET /api/v1/cars/{car_id}/maps/compare/figures/difference": {"params": {"first": "1"}},
    "POST /api/v1/cars/{car_id}/references": {"content": b"rpm,nm,efficiency"},
    "POST /api/v1/cars/{car_id}/references/{reference_id}/apply": {"json": {"version": 1, "key": ""}},
    "PATCH /api/v1/cars/{car_id}/maps/rules": {"json": {"verdicts": "healthy"}},
    "POST /api/v1/drives": {"json": {"problem": ACCELERATE}},
    "POST /api/v1/drives/check": {"json": {"problem": ACCELERATE}},
    "POST /api/v1/batteries": {"json": {"car_id": "0" * 32, "config": BATTERY}},
    "PATCH /api/v1/batteries/{battery_id}": {"json": {"name": "mine now"}},
    "PUT /api/v1/batteries/{battery_id}/config": {"json": BATTERY},
    "POST /api/v1/batteries/{battery_id}/data": {"content": b"t_s,current_a,voltage_v"},
    "POST /api/v1/batteries/{battery_id}/curve": {"content": b"t_s,current_a,voltage_v"},
    "POST /api/v1/batteries/{battery_id}/tests": {"json": {"at": "2026-03-01T08:00:00Z", "capacity_ah": 1.9}},
    "POST /api/v1/batteries/curves/figure": {"json": {"ocv": BATTERY["ocv"]}},
    "PATCH /api/v1/drives/{drive_id}": {"json": {"name": "mine now"}},
    "POST /api/v1/drives/{drive_id}/compare": {"json": {}},
    "POST /api/v1/drives/{drive_id}/front": {"json": {"emission": "co2"}},
    "PATCH /api/v1/trips/{trip_id}": {"json": {"name": "mine now"}},
    "POST /api/v1/trips/{trip_id}/reprocess": {"json": {}},
    "GET /api/v1/trips/{trip_id}/traces": {"params": {"signals": "speed_mps"}},
    "GET /api/v1/trips/{trip_id}/at": {"params": {"t_s": 1}},
    "GET /api/v1/trips/{trip_id}/export": {"params": {"format": "csv"}},
    "GET /api/v1/cars/{car_id}/maps/{version}/export": {"params": {"format": "json"}},
}
TUS = {
    "Tus-Resumable": "1.0.0",
    "Upload-Offset": "0",
    "Content-Type": "application/offset+octet-stream",
}


@dataclass
class FleetOf:
    """A person who has logged in, and identifiers of what their fleet has."""

    browser: TestClient
    ids: dict[str, str]


def settle(resources: Resources, app: Any, name: str) -> FleetOf:
    """Make a fleet with one of everything."""
    with resources.database.system_transaction() as session:
        fleet_id = accounts.add_fleet(session, name).id
    with resources.database.transaction(fleet_id) as session:
        accounts.add_user(session, f"{name}@example.org", PASSWORD)
    browser = TestClient(app, base_url=URL)
    login = browser.post("/api/v1/session", json={"email": f"{name}@example.org", "password": PASSWORD})
    assert login.status_code == 204
    car_id = browser.post("/api/v1/cars", json={"name": f"car of {name}"}).json()["id"]
    whole = {"car_id": car_id, "filename": f"{name}.csv"}
    sent = browser.post("/api/v1/trips", params=whole, content=signals_table(900, seed=len(name))).json()
    table = f"lat_deg,lon_deg,alt_m\n49,8,{len(name)}\n49.001,8,100\n".encode()
    road = browser.post("/api/v1/roads", params={"name": name}, content=table).json()
    subscription = {"url": "https://hooks.example.org/", "events": ["trip.ready"], "description": name}
    battery = {"car_id": car_id, "name": f"battery of {name}", "config": BATTERY}
    battery_id = browser.post("/api/v1/batteries", json=battery).json()["id"]
    at = f"/api/v1/batteries/{battery_id}"
    rows = f"t_s,current_a,voltage_v\n0,1,3.3\n1,{len(name)},3.3\n".encode()
    data = browser.post(f"{at}/data", params={"filename": name}, content=rows).json()
    test = {"at": "2026-03-01T08:00:00Z", "capacity_ah": 1.9, "note": name}
    webhook_id = browser.post("/api/v1/webhooks", json=subscription).json()["id"]
    points = "".join(f"{rpm},{nm},0.3\n" for rpm in (1000, 2000, 3000) for nm in (40, 60, len(name) + 70))
    reference = browser.post(f"/api/v1/cars/{car_id}/references", content=f"rpm,nm,efficiency\n{points}").json()
    with resources.database.transaction(fleet_id) as session:
        session.add(empty_map(car_id))
        alert = some_alert(car_id)
        session.add(alert)
        session.flush()
        alert_id = alert.id
        estimate = some_estimate(battery_id)
        session.add(estimate)
        session.flush()
        estimate_id = estimate.id
    return FleetOf(
        browser,
        {
            "car_id": car_id,
            "trip_id": sent["trip"]["id"],
            "job_id": sent["job"]["id"],
            "upload_id": Sender(browser, car_id).begin(100).rpartition("/")[2],
            "table_id": road["id"],
            "reference_id": reference["id"],
            "webhook_id": webhook_id,
            "drive_id": browser.post("/api/v1/drives", json={"name": name, "problem": ACCELERATE}).json()["id"],
            "delivery_id": browser.post(f"/api/v1/webhooks/{webhook_id}/test").json()["id"],
            "token_id": browser.post("/api/v1/tokens", json={"name": name}).json()["id"],
            "alert_id": alert_id,
            "battery_id": battery_id,
            "file_id": data["file"]["id"],
            "test_id": browser.post(f"{at}/tests", json=test).json()["id"],
            "estimate_id": estimate_id,
            "version": "1",
            "number": "1",
            "name": "contour",
        },
    )


def empty_map(car_id: str) -> MapVersion:
    return MapVersion(
        id=new_id(),
        car_id=car_id,
        version=1,
        key="",
        cells=0,
        trusted_cells=0,
        points=0,
        trips=0,
        provenance={},
        document_key="nowhere",
        created_at=now(),
    )


def some_estimate(battery_id: str) -> BatteryEstimate:
    began = now()
    about = {"source": "a trip", "key": "", "reason": "nothing moved", "code_version": "1"}
    return BatteryEstimate(battery_id=battery_id, began_at=began, ended_at=began, **about)


def some_alert(car_id: str) -> Alert:
    return Alert(
        car_id=car_id,
        quantity="mass",
        since_at=now(),
        trips=1,
        change=150.0,
        change_sd=20.0,
        unit="kg",
        chance=0.9,
        other="",
        words="Mass 150 kg above its usual",
        advice="Look into the boot.",
    )


@pytest.fixture
def fleets(settings: Settings, resources: Resources) -> Iterator[tuple[FleetOf, FleetOf]]:
    app = create_app(settings.model_copy(update={"auth": True}))
    with TestClient(app, base_url=URL):
        yield settle(resources, app, "ours"), settle(resources, app, "theirs")


OF_NOBODY = {"/api/v1/batteries/report/figures/{number}"}
"""Ask for a figure by its number in the report: no identifier of anything that a fleet owns."""


def operations(browser: TestClient) -> list[tuple[str, str]]:
    paths = browser.get("/openapi.json").json()["paths"]
    return [
        (method.upper(), path)
        for path, methods in paths.items()
        for method in sorted(methods, key=lambda m: m == "delete")  # what is there is removed last
        if path.startswith("/api/") and path not in NEVER_ENDS
    ]


def ask(fleet: FleetOf, method: str, path: str, ids: dict[str, str]) -> Any:
    extra: dict[str, Any] = dict(BODIES.get(f"{method} {path}", {}))
    extra["headers"] = TUS if path.startswith("/api/v1/uploads") and method != "GET" else {}
    return fleet.browser.request(method, path.format(**ids), **extra)


def without(text: str, ids: dict[str, str]) -> str:
    """Return an answer with the identifiers that were asked for blotted out."""
    for value in ids.values():
        text = text.replace(value, "…") if len(value) == 32 else text
    return text


def test_a_foreign_identifier_is_answered_like_an_unknown_one(fleets: tuple[FleetOf, FleetOf]) -> None:
    ours, theirs = fleets
    unknown = {name: value if name in ("version", "number", "name") else "0" * 32 for name, value in theirs.ids.items()}
    seen = 0
    for method, path in operations(ours.browser):
        if "{" not in path or path in OF_NOBODY:
            continue
        foreign, nobodys = ask(ours, method, path, theirs.ids), ask(ours, method, path, unknown)
        assert foreign.status_code == nobodys.status_code == 404, f"{method} {path}: {foreign.text}"
        assert without(foreign.text, theirs.ids) == without(nobodys.text, unknown)
        seen += 1
    assert seen > 30


def test_the_owner_is_not_answered_so(fleets: tuple[FleetOf, FleetOf]) -> None:
    """The control: with one's own identifiers, those very requests find what they are about (where that ends)."""
    ours, _ = fleets
    needs_results = (
        "/events",
        "/traces",
        "/at",
        "/figures/{name}",
        "/export",
        "/decode-report",
        "/consistency",
        "/maps/{version}",
        "/fits",
        "/curve",
    )
    for method, path in operations(ours.browser):
        if "{" in path and not path.endswith(needs_results) and method != "DELETE":
            assert ask(ours, method, path, ours.ids).status_code != 404, f"{method} {path}"


def test_no_list_shows_anything_foreign(fleets: tuple[FleetOf, FleetOf]) -> None:
    ours, theirs = fleets
    foreign = [value for name, value in theirs.ids.items() if name not in ("version", "number", "name")] + ["theirs"]
    for method, path in operations(ours.browser):
        if method == "GET" and "{" not in path:
            text = ours.browser.get(path).text
            assert not [value for value in foreign if value in text], path


def test_nothing_can_be_put_into_a_foreign_car(fleets: tuple[FleetOf, FleetOf]) -> None:
    ours, theirs = fleets
    whole = {"car_id": theirs.ids["car_id"], "filename": "x.csv"}
    assert ours.browser.post("/api/v1/trips", params=whole, content=signals_table(100)).status_code == 422
    assert Sender(ours.browser, theirs.ids["car_id"]).create(100).status_code == 422
    assert len(theirs.browser.get("/api/v1/trips").json()["items"]) == 1
    drive = {"problem": ACCELERATE, "car_id": theirs.ids["car_id"]}
    assert ours.browser.post("/api/v1/drives", json=drive).status_code == 422
    battery = {"car_id": theirs.ids["car_id"], "config": BATTERY}
    assert ours.browser.post("/api/v1/batteries", json=battery).status_code == 422


def test_a_filter_by_a_foreign_identifier_finds_nothing(fleets: tuple[FleetOf, FleetOf]) -> None:
    ours, theirs = fleets
    filters = ("/api/v1/trips", "car_id"), ("/api/v1/jobs", "trip_id"), ("/api/v1/drives", "car_id")
    filters += ("/api/v1/jobs", "battery_id"), ("/api/v1/batteries", "car_id")
    for path, name in (*filters, ("/api/v1/jobs", "drive_id")):
        assert ours.browser.get(path, params={name: theirs.ids[name]}).json()["items"] == []


def test_the_same_file_in_two_fleets_is_two_trips(fleets: tuple[FleetOf, FleetOf]) -> None:
    data = signals_table(5000)
    uploads = [Sender(fleet.browser, fleet.ids["car_id"]).send(data) for fleet in fleets]
    assert [upload["duplicate"] for upload in uploads] == [False, False]


def test_without_a_login_nothing_is_told(fleets: tuple[FleetOf, FleetOf]) -> None:
    ours, _ = fleets
    stranger = FleetOf(TestClient(ours.browser.app, base_url=URL), ours.ids)
    open_to_all = {"POST /api/v1/session", "DELETE /api/v1/session", "OPTIONS /api/v1/uploads"}
    for method, path in operations(ours.browser):
        if f"{method} {path}" not in open_to_all:
            answer = ask(stranger, method, path, ours.ids)
            assert answer.status_code == 401, f"{method} {path}"


def test_every_route_of_the_api_is_described(fleets: tuple[FleetOf, FleetOf]) -> None:
    """What is not described would be missed by the tests above."""
    from app import main

    ours, _ = fleets
    described = {path for _, path in operations(ours.browser)} | NEVER_ENDS
    modules = [getattr(main, name) for name in dir(main) if name.endswith("_routes")]
    assert len(modules) >= 7
    for module in modules:
        for route in module.router.routes:
            if isinstance(route, APIRoute):
                assert f"/api/v1{route.path}" in described
