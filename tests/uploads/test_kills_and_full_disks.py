"""A real server is killed in the middle of an upload, or its disk is full: what was received is kept, exactly."""

from __future__ import annotations

import errno
import hashlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import httpx
import pytest
from fastapi.testclient import TestClient

from app.main import create_app
from app.settings import Settings
from app.storage.migrate import migrate
from app.uploads.staging import Staging, Writer
from tests.services import BASE_URL, free_port, wait_for_port
from tests.uploads.conftest import Sender, checksum, signals_table

SIZE = 6_000_000


class Server:
    """A web server process that can be killed and started again on the same data."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.url = f"http://127.0.0.1:{settings.port}"
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        environment = os.environ | {
            "PONTHY_DATA_DIR": str(self.settings.data_dir),
            "PONTHY_PORT": str(self.settings.port),
            "PONTHY_DATABASE_URL": self.settings.database,
            "PONTHY_BROKER_URL": self.settings.broker,
            "PONTHY_UPLOAD_IDLE_S": "3",
        }
        self._process = subprocess.Popen([sys.executable, "-m", "workers", "web"], env=environment)
        wait_for_port(self.settings.port)

    def kill(self) -> None:
        if self._process is not None:
            self._process.send_signal(signal.SIGKILL)
            self._process.wait()
            self._process = None


@pytest.fixture
def server(settings: Settings) -> Iterator[Server]:
    running = Server(settings.model_copy(update={"port": free_port()}))
    running.start()
    yield running
    running.kill()


@pytest.fixture
def far_sender(server: Server) -> Iterator[Sender]:
    with httpx.Client(base_url=server.url, timeout=30.0) as http:
        yield Sender(http, http.post("/api/v1/cars", json={}).json()["id"])


def slowly(data: bytes, server: Server, kill_after: int) -> Iterator[bytes]:
    """Give data in packets, and kill the server after some of them."""
    for start in range(0, len(data), 65_536):
        if start >= kill_after:
            time.sleep(0.3)  # let the server take in what is on its way
            server.kill()
        yield data[start : start + 65_536]


def broken_patch(sender: Sender, url: str, offset: int, data: Iterator[bytes], **headers: str) -> None:
    with suppress(httpx.TransportError):
        sender.patch(url, offset, data, **headers)
        pytest.fail("the server answered although it was killed")


@pytest.mark.slow
def test_an_upload_survives_kills_of_the_server(server: Server, far_sender: Sender) -> None:
    data = signals_table(SIZE)
    url = far_sender.begin(SIZE)
    offset = 0
    for kill_after in (1_500_000, 2_500_000):
        broken_patch(far_sender, url, offset, slowly(data[offset:], server, kill_after))
        kept = Staging(server.settings.staging_dir).path(url.rpartition("/")[2]).read_bytes()
        assert kept == data[: len(kept)]
        server.start()
        assert far_sender.offset(url) == len(kept)
        assert len(kept) > offset
        offset = len(kept)
    assert far_sender.patch(url, offset, data[offset:]).status_code == 204
    upload = far_sender.show(url)
    assert (upload["state"], upload["sha256"]) == ("complete", hashlib.sha256(data).hexdigest())
    assert len(upload["trip_ids"]) == 1


@pytest.mark.slow
def test_of_a_chunk_with_a_checksum_nothing_counts_until_it_is_checked(server: Server, far_sender: Sender) -> None:
    data = signals_table(SIZE)
    url = far_sender.begin(SIZE)
    assert far_sender.patch(url, 0, data[:1000], **checksum("sha256", data[:1000])).status_code == 204
    rest = data[1000:]
    broken_patch(far_sender, url, 1000, slowly(rest, server, 3_000_000), **checksum("sha256", rest))
    server.start()
    assert far_sender.offset(url) == 1000
    assert far_sender.patch(url, 1000, rest, **checksum("sha256", rest)).status_code == 204
    assert far_sender.show(url)["sha256"] == hashlib.sha256(data).hexdigest()


def test_a_sender_that_goes_away_leaves_what_it_sent(far_sender: Sender) -> None:
    data = signals_table(SIZE)
    url = far_sender.begin(SIZE)

    def leave() -> Iterator[bytes]:
        yield data[:2_000_000]
        raise ConnectionError("the browser was closed")

    with pytest.raises(ConnectionError):
        far_sender.patch(url, 0, leave())
    end = time.monotonic() + 20.0
    while far_sender.offset(url) < 1_900_000 and time.monotonic() < end:
        time.sleep(0.05)
    offset = far_sender.offset(url)
    assert 1_900_000 <= offset <= 2_000_000
    answer = far_sender.patch(url, offset, data[offset:])
    while answer.status_code == 423 and time.monotonic() < end:  # the server may still wait for the lost sender
        time.sleep(0.1)
        answer = far_sender.patch(url, offset, data[offset:])
    assert far_sender.show(url)["sha256"] == hashlib.sha256(data).hexdigest()


def test_a_silent_sender_frees_the_upload(server: Server, far_sender: Sender) -> None:
    url = far_sender.begin(100)
    head = (
        f"PATCH {url} HTTP/1.1\r\nHost: 127.0.0.1:{server.settings.port}\r\nTus-Resumable: 1.0.0\r\n"
        "Upload-Offset: 0\r\nContent-Type: application/offset+octet-stream\r\nContent-Length: 100\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", server.settings.port), timeout=30.0) as silent:
        silent.sendall(head.encode() + b"t_s,speed_mps\n")
        answer = silent.recv(4096).decode()
        assert answer.startswith("HTTP/1.1 408 ")
        assert "sender-silent" in answer + silent.recv(4096).decode()
        assert far_sender.offset(url) == 14
        assert far_sender.patch(url, 14, b"0,1\n").status_code == 204


def full_after(room: int) -> object:
    """Return a `Writer.write` for a disk with so many bytes left."""
    write = Writer.write
    left = [room]

    def write_what_fits(self: Writer, data: bytes) -> None:
        fits = data[: left[0]]
        left[0] -= len(fits)
        write(self, fits)
        if len(fits) < len(data):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    return write_what_fits


def test_a_full_disk_keeps_what_fitted(sender: Sender, monkeypatch: pytest.MonkeyPatch) -> None:
    data = signals_table(SIZE)
    url = sender.begin(SIZE)
    with monkeypatch.context() as patch:
        patch.setattr(Writer, "write", full_after(2_500_000))
        answer = sender.patch(url, 0, data)
    assert (answer.status_code, answer.json()["code"]) == (507, "storage-full")
    assert sender.offset(url) == 2_500_000
    assert sender.patch(url, 2_500_000, data[2_500_000:]).status_code == 204
    assert sender.show(url)["sha256"] == hashlib.sha256(data).hexdigest()


def test_a_full_disk_with_the_creation_still_tells_where_the_upload_is(
    sender: Sender, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = signals_table(10_000)
    with monkeypatch.context() as patch:
        patch.setattr(Writer, "write", full_after(4000))
        answer = sender.create(len(data), body=data)
    assert answer.status_code == 507
    assert sender.offset(answer.headers["Location"]) == 4000


def test_a_really_full_disk_is_survived(small_disk: Path) -> None:
    settings = Settings(data_dir=small_disk)
    migrate(settings)
    data = signals_table(5_000_000)
    with TestClient(create_app(settings), base_url=BASE_URL) as http:
        sender = Sender(http, http.post("/api/v1/cars", json={}).json()["id"])
        url = sender.begin(len(data))
        ballast = small_disk / "ballast"
        room = os.statvfs(small_disk)
        ballast.write_bytes(bytes(room.f_bavail * room.f_bsize - 3_000_000))
        answer = sender.patch(url, 0, data)
        assert (answer.status_code, answer.json()["code"]) == (507, "storage-full")
        offset = sender.offset(url)
        assert 2_000_000 < offset < 3_100_000
        ballast.unlink()
        assert sender.patch(url, offset, data[offset:]).status_code == 204
        upload = sender.show(url)
    assert (upload["state"], upload["sha256"]) == ("complete", hashlib.sha256(data).hexdigest())
