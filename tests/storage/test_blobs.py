"""Files by key: in a folder, and in an object store where one is configured for the tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.storage.blobs import Blobs


@pytest.fixture
def blobs(tmp_path: Path) -> Blobs:
    return Blobs(tmp_path / "files")


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
    assert max(map(len, pieces)) <= 10_000


def test_a_finished_file_is_adopted_once_and_again(blobs: Blobs, tmp_path: Path) -> None:
    file = tmp_path / "upload.part"
    file.write_bytes(b"content")
    blobs.adopt("fleets/a/uploads/1", file)
    blobs.adopt("fleets/a/uploads/1", file)
    file.unlink()
    assert blobs.get("fleets/a/uploads/1") == b"content"


def test_a_file_on_another_disk_is_copied(blobs: Blobs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(18, "Invalid cross-device link")

    monkeypatch.setattr("os.link", refuse)
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
