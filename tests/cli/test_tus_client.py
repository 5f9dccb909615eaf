"""The upload client against a server that breaks connections, loses chunks and refuses."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from app.cli import tus
from app.cli.tus import Service
from app.errors import PonthyError


class Unreliable(ThreadingHTTPServer):
    """Keeps what it received and does to each chunk what its script says."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.received = bytearray()
        self.size = 0
        self.metadata: dict[str, str] = {}
        self.tokens: set[str | None] = set()
        self.script: list[str] = []
        self.refusals: list[int] = []


class Handler(BaseHTTPRequestHandler):
    server: Unreliable

    def do_POST(self) -> None:
        self.server.tokens.add(self.headers["Authorization"])
        self.server.size = int(self.headers["Upload-Length"])
        pairs = (pair.split(" ") for pair in self.headers["Upload-Metadata"].split(","))
        self.server.metadata = {key: base64.b64decode(value).decode() for key, value in pairs}
        self.reply(201, {"Location": "http://elsewhere.example/api/v1/uploads/1"})

    def do_HEAD(self) -> None:
        self.reply(200, {"Upload-Offset": str(len(self.server.received))})

    def do_PATCH(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        assert int(self.headers["Upload-Offset"]) == len(self.server.received)
        algorithm, checksum = self.headers["Upload-Checksum"].split(" ")
        assert (algorithm, base64.b64decode(checksum)) == ("sha256", hashlib.sha256(body).digest())
        what = self.server.script.pop(0) if self.server.script else "take"
        if what == "take":
            self.server.received += body
            self.reply(204, {"Upload-Offset": str(len(self.server.received))})
        elif what == "half then silence":
            self.server.received += body[: len(body) // 2]
            self.close_connection = True
        elif what == "all then silence":
            self.server.received += body
            self.close_connection = True
        else:
            self.reply(int(what), {}, {"code": "some-code", "detail": "Some reason."})

    def do_GET(self) -> None:
        if self.server.refusals:
            self.reply(self.server.refusals.pop(0), {}, {"code": "some-code", "detail": "Some reason."})
            return
        self.reply(200, {}, {"id": "1", "state": "complete", "trip_ids": ["t"], "job_id": "j"})

    def reply(self, status: int, headers: dict[str, str], document: object = None) -> None:
        body = b"" if document is None else json.dumps(document).encode()
        self.send_response(status)
        for name, value in (headers | {"Content-Length": str(len(body))}).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Keep the test's output quiet."""


@pytest.fixture
def server() -> Iterator[Unreliable]:
    with Unreliable() as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


@pytest.fixture
def image(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(tus, "CHUNK_BYTES", 1000)
    path = tmp_path / "Ölspur, 3.dat"
    path.write_bytes(bytes(i * 7 % 256 for i in range(4321)))
    return path


def service(server: Unreliable, pauses: list[float]) -> Service:
    return Service(f"http://127.0.0.1:{server.server_address[1]}", "secret", pauses.append)


def test_goes_on_where_the_server_stopped(server: Unreliable, image: Path) -> None:
    server.script = ["take", "half then silence", "503", "all then silence", "409"]
    pauses: list[float] = []
    told: list[int] = []
    metadata = {"filename": image.name, "car_id": "c", "kind": "trip"}

    upload = service(server, pauses).send(image, metadata, lambda sent, _size: told.append(sent))

    assert bytes(server.received) == image.read_bytes()
    assert server.metadata == metadata
    assert server.tokens == {"Bearer secret"}
    assert upload["trip_ids"] == ["t"]
    assert told[-1] == 4321
    assert told == sorted(told)
    assert pauses == [0.5, 0.5, 1.0, 0.5]


def test_gives_up_after_a_last_refusal_with_the_servers_words(server: Unreliable, image: Path) -> None:
    server.script = ["413"]
    pauses: list[float] = []
    with pytest.raises(PonthyError, match=r"Some reason\. \(HTTP 413\)") as caught:
        service(server, pauses).send(image, {"filename": "x"})
    assert (caught.value.code, pauses) == ("some-code", [])


def test_notices_a_file_that_shrinks(server: Unreliable, image: Path) -> None:
    def shrink(_sent: int, _size: int) -> None:
        image.write_bytes(b"x" * 10)

    with pytest.raises(PonthyError, match="became shorter"):
        service(server, []).send(image, {"filename": "x"}, shrink)


def test_patience_has_an_end(server: Unreliable, image: Path) -> None:
    server.script = ["503"] * 20
    pauses: list[float] = []
    with pytest.raises(PonthyError, match="HTTP 503"):
        service(server, pauses).send(image, {"filename": "x"})
    assert pauses == list(tus.WAITS_S)


def test_says_at_once_when_nobody_answers(image: Path) -> None:
    pauses: list[float] = []
    with pytest.raises(OSError, match=r"127\.0\.0\.1:9 doesn't answer: .*refused.*running there"):
        Service("http://127.0.0.1:9", None, pauses.append).send(image, {"filename": "x"})
    assert pauses == []


def test_insists_on_an_answer(server: Unreliable) -> None:
    server.refusals = [503, 429]
    pauses: list[float] = []
    assert service(server, pauses).insist("GET", "/api/v1/jobs/1").json()["id"] == "1"
    server.refusals = [409]
    with pytest.raises(PonthyError, match="HTTP 409"):
        service(server, pauses).insist("GET", "/api/v1/jobs/1")
    assert pauses == [0.5, 1.0]
