"""A small client of the service's resumable uploads (tus 1.0), on the standard library alone."""

from __future__ import annotations

import base64
import hashlib
import http.client
import json
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.cli.output import note
from app.errors import PonthyError

CHUNK_BYTES = 8 * 1024**2
TIMEOUT_S = 120.0
WAITS_S = (0.5, 1.0, 2.0, 4.0, 8.0, 15.0, 30.0)
"""Pauses between attempts after a broken connection or a busy server; they begin anew when something got through."""
PASSING = {408, 425, 429, 500, 502, 503, 504}
"""Answers that may be others a little later."""
OUT_OF_STEP = {409, 423, 460}
"""Answers to a chunk after which to ask for the offset: it is another one, it is held, the chunk came damaged (tus)."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What the server said."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    def json(self) -> dict[str, Any]:
        """Return the body as a JSON object."""
        document: dict[str, Any] = json.loads(self.body)
        return document


class Service:
    """A running Ponthy somewhere.

    Parameters
    ----------
    url : str
        For example ``http://localhost:8321``.
    token : str, optional
        API token; a server on loopback needs none.
    pause : callable, optional
        How to wait for some seconds; without it, say so and sleep.
    """

    def __init__(self, url: str, token: str | None = None, pause: Callable[[float], None] | None = None) -> None:
        self.url = url
        self._token = token
        self._pause = pause or wait_aloud

    def request(
        self, method: str, path: str, *, body: bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Answer:
        """Send one request.

        Raises
        ------
        PonthyError
            With the server's own words when it refuses.
        OSError
            When there is no answer.
        """
        authorization = {"Authorization": f"Bearer {self._token}"} if self._token else {}
        request = urllib.request.Request(  # noqa: S310 - the command takes http and https addresses only
            urllib.parse.urljoin(self.url, path),
            data=body,
            method=method,
            headers={"Tus-Resumable": "1.0.0", **authorization, **(headers or {})},
        )
        try:
            with urllib.request.urlopen(request, timeout=TIMEOUT_S) as reply:  # noqa: S310 - as above
                return Answer(reply.status, reply.headers, reply.read())
        except urllib.error.HTTPError as error:
            with error:
                raise refusal(error.code, error.read()) from None
        except (urllib.error.URLError, http.client.HTTPException) as error:
            reason = getattr(error, "reason", error)
            raise ConnectionError(f"{self.url} doesn't answer: {reason}. Is Ponthy running there?") from error

    def insist(
        self, method: str, path: str, *, body: bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Answer:
        """Send a request that may safely be sent again, until it is answered or patience runs out."""
        for wait_s in (*WAITS_S, None):
            try:
                return self.request(method, path, body=body, headers=headers)
            except (PonthyError, OSError) as error:
                if wait_s is None or not may_pass(error):
                    raise
                self._pause(wait_s)
        raise AssertionError("the last attempt either returns or raises")

    def send(
        self, path: Path, metadata: Mapping[str, str], progress: Callable[[int, int], None] = lambda _sent, _size: None
    ) -> dict[str, Any]:
        """Upload a file; after any interruption go on where the server says it stopped.

        Parameters
        ----------
        path : Path
        metadata : mapping of str to str
            ``filename``, ``car_id``, ``kind``.
        progress : callable
            Called with the bytes the server has and the bytes of the file.

        Returns
        -------
        dict
            The upload as the API shows it: its trips, its job, whether the content was there already.
        """
        size = path.stat().st_size
        pairs = ",".join(f"{key} {base64.b64encode(value.encode()).decode()}" for key, value in metadata.items())
        made = self.request("POST", "/api/v1/uploads", headers={"Upload-Length": str(size), "Upload-Metadata": pairs})
        location = urllib.parse.urlsplit(made.headers["Location"]).path  # the token goes to no other host
        offset, waits = int(made.headers.get("Upload-Offset", "0")), list(WAITS_S)
        with path.open("rb") as file:
            while offset < size:
                file.seek(offset)
                piece = file.read(CHUNK_BYTES)
                if not piece:
                    raise PonthyError("file-changed", f"{path} became shorter while it was sent. Send it again.")
                try:
                    offset = self._chunk(location, offset, piece)
                    waits = list(WAITS_S)
                except (PonthyError, OSError) as error:
                    if not waits or not may_pass(error, OUT_OF_STEP):
                        raise
                    self._pause(waits.pop(0))
                    before, offset = offset, int(self.insist("HEAD", location).headers["Upload-Offset"])
                    if offset > before:
                        waits = list(WAITS_S)
                progress(offset, size)
        return self.insist("GET", location).json()

    def _chunk(self, location: str, offset: int, data: bytes) -> int:
        checksum = base64.b64encode(hashlib.sha256(data).digest()).decode()
        headers = {
            "Upload-Offset": str(offset),
            "Upload-Checksum": f"sha256 {checksum}",
            "Content-Type": "application/offset+octet-stream",
        }
        return int(self.request("PATCH", location, body=data, headers=headers).headers["Upload-Offset"])


def may_pass(error: PonthyError | OSError, further: Collection[int] = ()) -> bool:
    """Say whether a failure may pass by itself: no answer, or one of the statuses that don't stay."""
    return error.status in PASSING or error.status in further if isinstance(error, PonthyError) else True


def wait_aloud(seconds: float) -> None:
    """Wait, and say so."""
    note(f"interrupted; trying again in {seconds:g} s")
    time.sleep(seconds)


def refusal(status: int, body: bytes) -> PonthyError:
    """Return the server's problem document as an error; of anything else that answered, say its status."""
    try:
        document = json.loads(body)
        return PonthyError(document["code"], f"{document['detail']} (HTTP {status})", status)
    except (ValueError, KeyError, TypeError):
        return PonthyError("refused", f"The server answered HTTP {status}. Is the URL that of a Ponthy?", status)
