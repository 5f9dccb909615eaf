"""Files by key: in a folder and in an object store alike."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.storage.blobs import Blobs, FilesUnavailable
from tests.services import free_port
from tests.storage.object_store import running_store


@pytest.fixture(params=["folder", "object store"])
def blobs(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Blobs]:
    if request.param == "folder":
        yield Blobs(tmp_path / "files")
        return
    for name, value in {"ACCESS_KEY_ID": "test", "SECRET_ACCESS_KEY": "test", "REGION": "eu-central-1"}.items():
        monkeypatch.setenv(f"AWS_{name}", value)
    with running_store() as endpoint:
        yield Blobs(tmp_path / "files", "s3://bucket/ponthy", endpoint)


def test_bytes_come_back(blobs: Blobs) -> None:
    blobs.put("fleets/a/x", b"one")
    blobs.put("fleets/a/x", b"two")
    assert blobs.get("fleets/a/x") == b"two"
    assert blobs.size("fleets/a/x") == 3
    assert blobs.exists("fleets/a/x")


def test_a_new_key_is_written_once(blobs: Blobs) -> None:
    assert blobs.put_new("k", b"first")
    assert not blobs.put_new("k", b"second")
    assert blobs.get("k") == b"first"


def test_a_missing_key_is_a_missing_file(blobs: Blobs) -> None:
    with pytest.raises(FileNotFoundError):
        blobs.get("nothing")
    assert not blobs.exists("nothing")
    blobs.delete("nothing")


def test_a_stream_gives_all_bytes_in_small_pieces(blobs: Blobs) -> None:
    data = bytes(range(256)) * 1000
    blobs.put("long", data)
    pieces = list(blobs.stream("long", chunk_bytes=10_000))
    assert b"".join(pieces) == data
    assert len(pieces) > 1 or blobs.local_path("long") is None


def test_a_file_larger_than_one_part_is_stored_whole(blobs: Blobs, tmp_path: Path) -> None:
    file = tmp_path / "upload.part"
    data = bytes(range(251)) * 60_000
    file.write_bytes(data)
    blobs.adopt("large", file)
    assert blobs.size("large") == len(data)
    assert b"".join(blobs.stream("large")) == data


def test_a_finished_file_is_adopted_once_and_again(blobs: Blobs, tmp_path: Path) -> None:
    file = tmp_path / "upload.part"
    file.write_bytes(b"content")
    blobs.adopt("fleets/a/uploads/1", file)
    blobs.adopt("fleets/a/uploads/1", file)
    file.unlink()
    assert blobs.get("fleets/a/uploads/1") == b"content"


def test_a_file_on_another_disk_is_copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(18, "Invalid cross-device link")

    monkeypatch.setattr("os.link", refuse)
    blobs = Blobs(tmp_path / "files")
    file = tmp_path / "upload.part"
    file.write_bytes(b"content")
    blobs.adopt("k", file)
    assert blobs.get("k") == b"content"


def test_keys_below_a_prefix_are_listed_and_removed(blobs: Blobs) -> None:
    for key in ("fleets/a/trips/1/x", "fleets/a/trips/1/y", "fleets/a/trips/12/x"):
        blobs.put(key, b"")
    assert blobs.keys("fleets/a/trips/1") == ["fleets/a/trips/1/x", "fleets/a/trips/1/y"]
    blobs.delete_below("fleets/a/trips/1")
    assert blobs.keys("fleets") == ["fleets/a/trips/12/x"]


def test_the_store_answers(blobs: Blobs) -> None:
    blobs.check()


def test_a_store_that_does_not_answer_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "test")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "test")
    blobs = Blobs(tmp_path, "s3://bucket/ponthy", f"http://127.0.0.1:{free_port()}")
    with pytest.raises(FilesUnavailable):
        blobs.get("k")


def test_a_full_disk_is_named(small_disk: Path) -> None:
    blobs = Blobs(small_disk / "files")
    for put in (blobs.put, blobs.put_new):
        with pytest.raises(OSError, match="No space left") as raised:
            put("k", bytes(20_000_000))
        assert raised.value.errno == errno.ENOSPC
