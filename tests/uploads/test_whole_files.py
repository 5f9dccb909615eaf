"""A file sent in one request, as curl does it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import httpx
import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID
from app.main import create_app
from app.settings import Settings
from app.storage.blobs import Blobs
from app.storage.resources import Resources
from app.uploads.staging import Staging, Writer
from tests.services import BASE_URL
from tests.storage.object_store import running_store
from tests.uploads.conftest import Sender, signals_table
from tests.uploads.test_finishing import PICTURE
from tests.uploads.test_kills_and_full_disks import full_after


def post(sender: Sender, data: bytes | Iterator[bytes], filename: str = "trip.csv") -> httpx.Response:
    return sender.http.post("/api/v1/trips", params={"car_id": sender.car_id, "filename": filename}, content=data)


def test_a_file_in_one_request_becomes_a_trip(sender: Sender) -> None:
    data = signals_table(3_000_000)
    answer = post(sender, iter([data[:1000], data[1000:]]))
    assert answer.status_code == 202
    said = answer.json()
    assert said["upload"]["sha256"] == hashlib.sha256(data).hexdigest()
    assert said["upload"]["trip_ids"] == [said["trip"]["id"]]
    assert said["job"]["trip_id"] == said["trip"]["id"]


def test_the_same_file_again_is_answered_with_its_trip(sender: Sender) -> None:
    data = signals_table(2000)
    first, second = post(sender, data).json(), post(sender, data).json()
    assert second["upload"]["duplicate"]
    assert second["trip"]["id"] == first["trip"]["id"] == sender.send(data)["trip_ids"][0]


def test_a_file_that_can_not_be_used_is_refused_and_kept(sender: Sender, resources: Resources) -> None:
    answer = post(sender, PICTURE, "holiday.jpg")
    assert (answer.status_code, answer.json()["code"]) == (422, "wrong-kind-of-file")
    assert "JPEG" in answer.json()["detail"]
    upload = sender.show(f"/api/v1/uploads/{answer.json()['upload_id']}")
    assert upload["state"] == "failed"
    assert [resources.blobs.get(key) for key in resources.blobs.keys("fleets")] == [PICTURE]


def test_an_empty_body_is_refused(sender: Sender) -> None:
    assert post(sender, b"").json()["code"] == "empty-file"


def test_too_long_a_body_leaves_nothing(settings: Settings) -> None:
    small = settings.model_copy(update={"max_upload_bytes": 1000})
    with TestClient(create_app(small), base_url=BASE_URL) as http:
        sender = Sender(http, http.post("/api/v1/cars", json={}).json()["id"])
        assert post(sender, signals_table(1001)).status_code == 413
        assert http.get("/api/v1/uploads").json()["items"] == []
    assert Staging(settings.staging_dir).upload_ids() == []


def test_a_full_disk_leaves_nothing(sender: Sender, resources: Resources, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(Writer, "write", full_after(1000))
        assert post(sender, signals_table(5000)).status_code == 507
    assert sender.http.get("/api/v1/uploads").json()["items"] == []
    assert Staging(resources.settings.staging_dir).upload_ids() == []


def test_an_unknown_car_is_told_before_the_file_is_read(sender: Sender) -> None:
    sender.car_id = "0" * 32
    assert post(sender, signals_table(100)).json()["field"] == "car_id"


def test_an_object_store_takes_the_files(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in {"ACCESS_KEY_ID": "test", "SECRET_ACCESS_KEY": "test", "REGION": "eu-central-1"}.items():
        monkeypatch.setenv(f"AWS_{name}", value)
    data = signals_table(9_000_000)
    with running_store() as endpoint:
        stored = settings.model_copy(update={"blob_url": "s3://bucket/ponthy", "s3_endpoint": endpoint})
        with TestClient(create_app(stored), base_url=BASE_URL) as http:
            sender = Sender(http, http.post("/api/v1/cars", json={}).json()["id"])
            upload = sender.send(data)
            assert http.get("/health/ready").json()["ready"]
        blobs = Blobs(settings.blob_dir, stored.blob_url, endpoint)
        assert blobs.get(f"fleets/{DEFAULT_FLEET_ID}/uploads/{upload['id']}") == data
    assert Staging(settings.staging_dir).upload_ids() == []
