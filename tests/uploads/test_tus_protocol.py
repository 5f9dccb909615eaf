"""What the protocol promises: offsets, checksums, ending, expiring, one sender at a time."""

from __future__ import annotations

import hashlib
from datetime import timedelta
from email.utils import parsedate_to_datetime
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID
from app.storage.base import now
from app.storage.resources import Resources
from app.uploads.models import Upload
from app.uploads.staging import Staging
from tests.uploads.conftest import Sender, checksum, metadata, signals_table


def test_what_is_spoken_is_said(client: TestClient) -> None:
    answer = client.options("/api/v1/uploads")
    assert answer.status_code == 204
    assert answer.headers["Tus-Version"] == "1.0.0"
    assert set(answer.headers["Tus-Extension"].split(",")) == {
        "creation",
        "creation-with-upload",
        "checksum",
        "termination",
        "expiration",
    }
    assert answer.headers["Tus-Checksum-Algorithm"] == "sha1,sha256"
    assert int(answer.headers["Tus-Max-Size"]) == 4 * 1024**3


def test_a_file_in_pieces_becomes_a_trip(sender: Sender) -> None:
    data = signals_table(10_000)
    url = sender.begin(len(data))
    for start in range(0, len(data), 3000):
        answer = sender.patch(url, start, data[start : start + 3000])
        assert answer.status_code == 204
        assert int(answer.headers["Upload-Offset"]) == min(start + 3000, len(data))
        assert answer.headers["Tus-Resumable"] == "1.0.0"
    assert answer.headers["Upload-Result"] == url
    upload = sender.show(url)
    assert upload["state"] == "complete"
    assert upload["sha256"] == hashlib.sha256(data).hexdigest()
    assert upload["offset"] == upload["size"] == len(data)
    assert len(upload["trip_ids"]) == 1
    assert sender.http.get(f"/api/v1/jobs/{upload['job_id']}").json()["trip_id"] == upload["trip_ids"][0]


def test_the_bytes_are_kept_as_they_came(sender: Sender, resources: Resources) -> None:
    data = signals_table(5000)
    upload = sender.send(data)
    assert resources.blobs.get(f"fleets/{DEFAULT_FLEET_ID}/uploads/{upload['id']}") == data
    assert Staging(resources.settings.staging_dir).upload_ids() == []


def test_the_first_bytes_may_come_with_the_creation(sender: Sender) -> None:
    data = signals_table(2000)
    answer = sender.create(len(data), body=data[:500])
    assert answer.status_code == 201
    assert answer.headers["Upload-Offset"] == "500"
    assert sender.offset(answer.headers["Location"]) == 500
    whole = sender.create(len(data), body=data)
    assert whole.headers["Upload-Result"] == whole.headers["Location"]


def test_the_head_tells_what_is_there(sender: Sender) -> None:
    url = sender.begin(100, filename="März.csv")
    sender.patch(url, 0, b"t_s,speed_mps\n")
    answer = sender.head(url)
    assert answer.status_code == 200
    assert (answer.headers["Upload-Offset"], answer.headers["Upload-Length"]) == ("14", "100")
    assert answer.headers["Cache-Control"] == "no-store"
    assert metadata(filename="März.csv") in answer.headers["Upload-Metadata"]
    assert parsedate_to_datetime(answer.headers["Upload-Expires"]) > now()


def test_a_wrong_offset_is_a_conflict_that_tells_the_right_one(sender: Sender) -> None:
    url = sender.begin(100)
    sender.patch(url, 0, b"t_s,")
    answer = sender.patch(url, 2, b"xx")
    assert (answer.status_code, answer.json()["offset"]) == (409, 4)
    assert sender.offset(url) == 4


@pytest.mark.parametrize("algorithm", ["sha1", "sha256"])
def test_bytes_that_fit_their_checksum_are_kept(sender: Sender, algorithm: str) -> None:
    url = sender.begin(100)
    assert sender.patch(url, 0, b"t_s,", **checksum(algorithm, b"t_s,")).status_code == 204
    assert sender.offset(url) == 4


@pytest.mark.parametrize("algorithm", ["sha1", "sha256"])
def test_of_bytes_that_do_not_fit_none_is_kept(sender: Sender, algorithm: str) -> None:
    url = sender.begin(100)
    sender.patch(url, 0, b"t_s,")
    answer = sender.patch(url, 4, b"speed", **checksum(algorithm, b"other"))
    assert (answer.status_code, answer.json()["code"]) == (460, "checksum-mismatch")
    assert sender.offset(url) == 4
    assert sender.patch(url, 4, b"speed", **checksum(algorithm, b"speed")).status_code == 204


def test_more_than_was_agreed_is_refused_and_not_kept(sender: Sender) -> None:
    url = sender.begin(10)
    assert sender.patch(url, 0, b"x" * 11).status_code == 413
    assert sender.patch(url, 0, iter([b"x" * 6, b"x" * 6])).status_code == 413  # without a Content-Length
    assert sender.offset(url) == 0


def test_a_file_beyond_the_limit_is_refused_before_it_is_sent(sender: Sender) -> None:
    answer = sender.create(4 * 1024**3 + 1)
    assert (answer.status_code, answer.json()["code"]) == (413, "upload-too-large")


def test_only_one_sends_at_a_time(sender: Sender, resources: Resources) -> None:
    url = sender.begin(100)
    with Staging(resources.settings.staging_dir).writer(url.rpartition("/")[2]):
        answer = sender.patch(url, 0, b"t_s,")
        assert (answer.status_code, answer.json()["code"]) == (423, "upload-busy")
        assert sender.end(url).status_code == 423
    assert sender.patch(url, 0, b"t_s,").status_code == 204


def test_an_ended_upload_is_gone(sender: Sender, resources: Resources) -> None:
    url = sender.begin(100)
    sender.patch(url, 0, b"t_s,")
    assert sender.end(url).status_code == 204
    assert sender.head(url).status_code == 404
    assert sender.patch(url, 4, b"x").status_code == 404
    assert Staging(resources.settings.staging_dir).upload_ids() == []


def test_an_upload_that_is_a_trip_is_not_ended(sender: Sender) -> None:
    upload = sender.send(signals_table(500))
    answer = sender.end(f"/api/v1/uploads/{upload['id']}")
    assert (answer.status_code, answer.json()["code"]) == (409, "upload-in-use")


def test_an_expired_upload_is_gone(sender: Sender, resources: Resources) -> None:
    url = sender.begin(100)
    with resources.database.transaction(DEFAULT_FLEET_ID) as session:
        session.get_one(Upload, url.rpartition("/")[2]).expires_at = now() - timedelta(seconds=1)
    for answer in (sender.head(url), sender.patch(url, 0, b"x")):
        assert answer.status_code == 410


@pytest.mark.parametrize(
    ("headers", "status", "field"),
    [
        ({"Tus-Resumable": "0.2.2", "Upload-Length": "1"}, 412, "Tus-Resumable"),
        ({}, 400, "Upload-Length"),
        ({"Upload-Length": "-1"}, 400, "Upload-Length"),
        ({"Upload-Length": "1e3"}, 400, "Upload-Length"),
        ({"Upload-Defer-Length": "1"}, 400, "Upload-Defer-Length"),
        ({"Upload-Length": "1", "Upload-Metadata": "filename !!!"}, 400, "Upload-Metadata"),
        ({"Upload-Length": "1", "Upload-Metadata": metadata(kind="movie")}, 400, "Upload-Metadata"),
        ({"Upload-Length": "1", "Upload-Metadata": metadata(filename="x")}, 422, "Upload-Metadata"),
        ({"Upload-Length": "1", "Upload-Metadata": metadata(car_id="0" * 32)}, 422, "car_id"),
        (
            {"Upload-Length": "1", "Upload-Metadata": metadata(car_id="0" * 32, mapping='{"signals": 1}')},
            422,
            "mapping.signals",
        ),
    ],
)
def test_a_creation_that_makes_no_sense_is_refused(
    client: TestClient, headers: dict[str, str], status: int, field: str
) -> None:
    answer = client.post("/api/v1/uploads", headers={"Tus-Resumable": "1.0.0", **headers})
    assert (answer.status_code, answer.json()["field"]) == (status, field)
    assert answer.headers["Tus-Resumable"] == "1.0.0"
    assert answer.headers["Content-Type"] == "application/problem+json"


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Content-Type": "text/plain"}, 415),
        ({"Upload-Offset": "first"}, 400),
        ({"Upload-Checksum": "md5 AAAA"}, 400),
        ({"Upload-Checksum": "sha1 ????"}, 400),
    ],
)
def test_a_piece_that_makes_no_sense_is_refused(sender: Sender, headers: dict[str, Any], status: int) -> None:
    url = sender.begin(100)
    assert sender.patch(url, 0, b"x", **headers).status_code == status
    assert sender.offset(url) == 0


@pytest.mark.parametrize(
    ("name", "kept"),
    [("../../etc/passwd", "passwd"), ("C:\\trips\\a.dat", "a.dat"), ("a\x00b\n.dat", "ab.dat"), ("", "upload")],
)
def test_file_names_are_names_only(sender: Sender, name: str, kept: str) -> None:
    assert sender.show(sender.begin(10, filename=name))["filename"] == kept
