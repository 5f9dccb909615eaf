"""What becomes of a complete file: a trip, the trip that is there already, an elevation table, or a clear problem."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest

from app.accounts.models import DEFAULT_FLEET_ID
from app.errors import StorageFull
from app.storage.resources import Resources
from app.uploads import finishing, receiving, service
from app.uploads.models import Upload
from app.uploads.staging import Staging
from tests.uploads.conftest import Sender, signals_table

ELEVATION = b"lat_deg,lon_deg,alt_m,way\n49.35,8.68,112.4,1\n49.3504,8.6801,112.9,1\n49.3508,8.6802,113.1,1\n"


def test_the_same_content_is_answered_with_the_same_trip(sender: Sender) -> None:
    data = signals_table(3000)
    first, second = sender.send(data), sender.send(data, filename="copy.csv")
    assert (first["duplicate"], second["duplicate"]) == (False, True)
    assert second["trip_ids"] == first["trip_ids"]
    assert second["job_id"] == first["job_id"]
    assert len(sender.http.get("/api/v1/jobs").json()["items"]) == 1


def test_the_same_content_for_another_car_is_another_trip(sender: Sender) -> None:
    data = signals_table(3000)
    other = sender.http.post("/api/v1/cars", json={}).json()["id"]
    assert sender.send(data)["trip_ids"] != sender.send(data, car_id=other)["trip_ids"]


def test_two_browsers_send_the_same_file_at_once(
    sender: Sender, resources: Resources, monkeypatch: pytest.MonkeyPatch
) -> None:
    together = threading.Barrier(2, timeout=20)
    examine = finishing._examine

    def examine_together(*arguments: Any) -> finishing.Finding:
        finding = examine(*arguments)
        together.wait()
        return finding

    monkeypatch.setattr(finishing, "_examine", examine_together)
    data = signals_table(20_000)
    with ThreadPoolExecutor(2) as browsers:
        uploads = list(browsers.map(lambda _: sender.send(data), range(2)))
    assert sorted(upload["duplicate"] for upload in uploads) == [False, True]
    assert uploads[0]["trip_ids"] == uploads[1]["trip_ids"]
    assert len(uploads[0]["trip_ids"]) == 1
    assert [upload["state"] for upload in uploads] == ["complete", "complete"]
    assert len(resources.blobs.keys("fleets")) == 1
    assert Staging(resources.settings.staging_dir).upload_ids() == []


PICTURE = b"\xff\xd8\xff\xe0\x00\x10JFIF\x00" + bytes(range(256)) * 400


@pytest.mark.parametrize(
    ("name", "data"),
    [("holiday.jpg", PICTURE), ("invoice.pdf", b"%PDF-1.7\n" + b"%\xe2\xe3\xcf\xd3\n" * 3000), ("empty.dat", b"")],
)
def test_a_file_of_the_wrong_kind_ends_with_a_clear_problem(
    sender: Sender, resources: Resources, name: str, data: bytes
) -> None:
    url = sender.begin(len(data), filename=name)
    if data:
        sender.patch(url, 0, data)
    upload = sender.show(url)
    assert upload["state"] == "failed"
    assert upload["problem"]["status"] == 422
    assert upload["problem"]["detail"]
    assert upload["trip_ids"] == []
    assert resources.blobs.get(f"fleets/{DEFAULT_FLEET_ID}/uploads/{upload['id']}") == data
    assert sender.end(url).status_code == 204
    assert resources.blobs.keys("fleets") == []


def test_a_wrong_kind_is_told_before_all_is_sent(sender: Sender) -> None:
    url = sender.begin(10 * len(PICTURE), filename="holiday.jpg")
    sender.patch(url, 0, PICTURE)
    upload = sender.show(url)
    assert upload["state"] == "receiving"
    assert upload["problem"]["detail"]


def test_an_elevation_table_is_kept_and_known_again(sender: Sender) -> None:
    first, second = (sender.send(ELEVATION, kind="elevation", filename="hills.csv") for _ in range(2))
    assert (first["state"], first["duplicate"]) == ("complete", False)
    assert (second["state"], second["duplicate"]) == ("complete", True)
    (table,) = sender.http.get("/api/v1/roads").json()["items"]
    assert (table["name"], table["nodes"], table["bounds"]) == ("hills.csv", 3, [49.35, 8.68, 49.3508, 8.6802])


def test_a_bad_elevation_table_tells_the_row(sender: Sender, resources: Resources) -> None:
    upload = sender.send(b"lat_deg,lon_deg,alt_m\n49.35,8.68,112\n49.36,8.68,high\n", kind="elevation")
    assert upload["state"] == "failed"
    assert upload["problem"]["row"] == 3
    assert len(resources.blobs.keys("fleets")) == 1
    assert sender.end(f"/api/v1/uploads/{upload['id']}").status_code == 204
    assert resources.blobs.keys("fleets") == []


def test_a_table_outlives_its_upload(sender: Sender, resources: Resources) -> None:
    upload = sender.send(ELEVATION, kind="elevation")
    assert sender.end(f"/api/v1/uploads/{upload['id']}").status_code == 204
    (table,) = sender.http.get("/api/v1/roads").json()["items"]
    assert [resources.blobs.get(key) for key in resources.blobs.keys("fleets")] == [ELEVATION]
    assert sender.http.delete(f"/api/v1/roads/{table['id']}").status_code == 204
    assert resources.blobs.keys("fleets") == []


@pytest.fixture
def crash(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Let the process die, so to speak, between a file's last byte and the transaction; return what mends it."""

    def die(*_: object) -> None:
        raise StorageFull

    monkeypatch.setattr(receiving, "finish", die)
    return monkeypatch.undo


def left_complete(sender: Sender, crash: Callable[[], None]) -> str:
    data = signals_table(3000)
    url = sender.begin(len(data))
    assert sender.patch(url, 0, data).status_code == 507
    crash()
    return url


def test_the_next_head_finishes_what_a_crash_left(sender: Sender, crash: Callable[[], None]) -> None:
    url = left_complete(sender, crash)
    answer = sender.head(url)
    assert answer.headers["Upload-Offset"] == answer.headers["Upload-Length"]
    assert sender.show(url)["state"] == "complete"
    assert len(sender.show(url)["trip_ids"]) == 1


def test_the_next_patch_finishes_what_a_crash_left(sender: Sender, crash: Callable[[], None]) -> None:
    url = left_complete(sender, crash)
    assert sender.patch(url, 3000, b"").headers["Upload-Result"] == url
    assert sender.patch(url, 3000, b"").headers["Upload-Result"] == url
    assert len(sender.show(url)["trip_ids"]) == 1


def test_the_reaper_finishes_what_a_crash_left(sender: Sender, crash: Callable[[], None], resources: Resources) -> None:
    url = left_complete(sender, crash)
    service.reap(resources)
    service.reap(resources)
    assert len(sender.show(url)["trip_ids"]) == 1
    assert Staging(resources.settings.staging_dir).upload_ids() == []


def test_the_reaper_leaves_what_is_under_way_and_drops_strays(sender: Sender, resources: Resources) -> None:
    staging = Staging(resources.settings.staging_dir)
    under_way = sender.begin(100).rpartition("/")[2]
    staging.create("5" * 32)
    staging.create("6" * 32)
    with staging.writer("6" * 32):
        service.reap(resources)
    assert staging.upload_ids() == sorted([under_way, "6" * 32])


def test_an_expired_upload_is_reaped(sender: Sender, resources: Resources) -> None:
    url = sender.begin(100)
    sender.patch(url, 0, b"t_s,")
    with resources.database.transaction(DEFAULT_FLEET_ID) as session:
        row = session.get_one(Upload, url.rpartition("/")[2])
        row.expires_at = row.created_at
    service.reap(resources)
    assert sender.http.get(url).status_code == 404
    assert Staging(resources.settings.staging_dir).upload_ids() == []


def test_a_removed_car_takes_its_uploads_along(sender: Sender, resources: Resources) -> None:
    sender.send(signals_table(1000))
    sender.send(PICTURE, filename="x.jpg")
    sender.begin(100)
    answer: httpx.Response = sender.http.delete(f"/api/v1/cars/{sender.car_id}", params={"with_trips": True})
    assert answer.status_code == 204
    assert sender.http.get("/api/v1/uploads").json()["items"] == []
    assert resources.blobs.keys("fleets") == []
    assert Staging(resources.settings.staging_dir).upload_ids() == []


def test_a_car_removed_at_the_last_moment_leaves_nothing(
    sender: Sender, resources: Resources, monkeypatch: pytest.MonkeyPatch
) -> None:
    examine = finishing._examine

    def remove_the_car_meanwhile(*arguments: Any) -> finishing.Finding:
        finding = examine(*arguments)
        sender.http.delete(f"/api/v1/cars/{sender.car_id}")
        return finding

    monkeypatch.setattr(finishing, "_examine", remove_the_car_meanwhile)
    url = sender.begin(1000)
    assert sender.patch(url, 0, signals_table(1000)).status_code == 404
    assert sender.http.get("/api/v1/uploads").json()["items"] == []
    assert Staging(resources.settings.staging_dir).upload_ids() == []
    assert resources.blobs.keys("fleets") == []
