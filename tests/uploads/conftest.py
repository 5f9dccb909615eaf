"""A sender that speaks tus, and content that can be told apart."""

from __future__ import annotations

import base64
import hashlib
from dataclasses import dataclass, field
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient

BODY = "application/offset+octet-stream"


def signals_table(size: int, seed: int = 0) -> bytes:
    """Return a signals table of a given length whose content depends on the seed."""
    header = b"t_s,speed_mps\n"
    rows = b"".join(b"%d.%d,%d.25\n" % (n, seed % 10, (n * 7 + seed) % 50) for n in range(size // 8 + 1))
    return (header + rows)[: size - 1] + b"\n"


def metadata(**values: str) -> str:
    return ",".join(f"{key} {base64.b64encode(value.encode()).decode()}" for key, value in values.items())


def checksum(algorithm: str, data: bytes) -> dict[str, str]:
    digest = hashlib.new(algorithm, data).digest()
    return {"Upload-Checksum": f"{algorithm} {base64.b64encode(digest).decode()}"}


@dataclass
class Sender:
    """Sends files to one car's trips, over any HTTP client."""

    http: httpx.Client
    car_id: str
    headers: dict[str, str] = field(default_factory=dict)

    def create(self, size: int, body: bytes | None = None, **about: str) -> httpx.Response:
        about = {"filename": "trip.csv", "car_id": self.car_id} | about
        headers = {"Upload-Length": str(size), "Upload-Metadata": metadata(**about)}
        if body is not None:
            headers["Content-Type"] = BODY
        return self._ask("POST", "/api/v1/uploads", headers, body)

    def begin(self, size: int, **about: str) -> str:
        answer = self.create(size, **about)
        assert answer.status_code == 201, answer.text
        return str(answer.headers["Location"])

    def patch(self, url: str, offset: int, data: Any, **headers: str) -> httpx.Response:
        return self._ask("PATCH", url, {"Upload-Offset": str(offset), "Content-Type": BODY, **headers}, data)

    def head(self, url: str) -> httpx.Response:
        return self._ask("HEAD", url, {})

    def offset(self, url: str) -> int:
        return int(self.head(url).headers["Upload-Offset"])

    def end(self, url: str) -> httpx.Response:
        return self._ask("DELETE", url, {})

    def send(self, data: bytes, **about: str) -> dict[str, Any]:
        """Send a whole file in one chunk; return the upload."""
        url = self.begin(len(data), **about)
        answer = self.patch(url, 0, data)
        assert answer.status_code == 204, answer.text
        return self.show(url)

    def show(self, url: str) -> dict[str, Any]:
        answer = self.http.get(url, headers=self.headers)
        assert answer.status_code == 200, answer.text
        document: dict[str, Any] = answer.json()
        return document

    def _ask(self, method: str, url: str, headers: dict[str, str], body: Any = None) -> httpx.Response:
        every = {"Tus-Resumable": "1.0.0", **self.headers, **headers}
        return self.http.request(method, url, headers=every, content=body)


@pytest.fixture
def sender(client: TestClient) -> Sender:
    """Return a sender for a fresh car."""
    return Sender(client, client.post("/api/v1/cars", json={"name": "car"}).json()["id"])
