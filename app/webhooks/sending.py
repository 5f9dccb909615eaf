"""One POST to an address that has been checked, with a bound on everything."""

from __future__ import annotations

import http.client
import socket
import ssl
import time
from dataclasses import dataclass
from threading import Timer

from app.webhooks.addresses import Address, Target

TIMEOUT_S = 10.0
KEPT_ANSWER = 500
"""Letters that are kept of what a receiver answers."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What a receiver said."""

    status: int
    text: str


class NotAnswered(Exception):  # noqa: N818 - reads as what it says
    """Nobody was reached, or whoever it was gave no answer in time."""


class PinnedConnection(http.client.HTTPConnection):
    """A connection to one address of a target, whatever its name resolves to by now."""

    def __init__(self, target: Target, address: Address, timeout_s: float, context: ssl.SSLContext | None) -> None:
        super().__init__(target.host, target.port, timeout=timeout_s)
        self._target = target
        self._address = str(address)
        self._tls = context

    def connect(self) -> None:
        """Connect; over TLS the certificate must be that of the target's name."""
        self.sock = socket.create_connection((self._address, self._target.port), timeout=self.timeout)
        if self._tls is not None:
            self.sock = self._tls.wrap_socket(self.sock, server_hostname=self._target.host)


def post(
    target: Target,
    addresses: list[Address],
    body: bytes,
    headers: dict[str, str],
    *,
    timeout_s: float = TIMEOUT_S,
    context: ssl.SSLContext | None = None,
) -> Answer:
    """Send a body and return the answer, whatever its status; a redirection is not followed.

    Parameters
    ----------
    target : Target
    addresses : list of addresses
        Tried in turn until one takes the connection.
    body : bytes
    headers : dict
    timeout_s : float
        For everything together, from the first connection to the last letter.
    context : ssl.SSLContext, optional
        What a secure target's certificate is checked with; the system's authorities otherwise.

    Raises
    ------
    NotAnswered
        When no address could be connected to, or there was no whole answer in time.
    """
    end = time.monotonic() + timeout_s
    tls = (context or ssl.create_default_context()) if target.secure else None
    connection = _connected(target, addresses, end, tls)
    cut = Timer(max(end - time.monotonic(), 0.0), _cut, (connection.sock,))  # each read has a timeout, a drip has none
    cut.start()
    try:
        connection.request("POST", target.path, body, {"Host": target.authority, "Connection": "close"} | headers)
        response = connection.getresponse()
        text = response.read(4 * KEPT_ANSWER).decode("utf-8", "replace")
        if time.monotonic() >= end:
            raise TimeoutError  # cut in the middle, which reads like an early end
    except (OSError, http.client.HTTPException, ValueError) as error:
        late = time.monotonic() >= end
        reason = f"no whole answer within {timeout_s:g} s" if late else _reason(error)
        raise NotAnswered(reason) from error
    finally:
        cut.cancel()
        connection.close()
    return Answer(response.status, "".join(letter for letter in text if letter.isprintable() or letter == "\n"))


def _connected(
    target: Target, addresses: list[Address], end: float, tls: ssl.SSLContext | None
) -> http.client.HTTPConnection:
    failure: OSError = TimeoutError("timed out")
    for number, address in enumerate(addresses):
        left = (end - time.monotonic()) / (len(addresses) - number)  # a dead one leaves the others their share
        if left <= 0:
            break
        connection = PinnedConnection(target, address, left, tls)
        try:
            connection.connect()
        except OSError as error:
            connection.close()
            failure = error
            continue
        connection.sock.settimeout(max(end - time.monotonic(), 0.01))
        return connection
    raise NotAnswered(_reason(failure)) from failure


def _cut(sock: socket.socket) -> None:
    try:
        socket.socket.shutdown(sock, socket.SHUT_RDWR)  # not TLS' own, which would wait for the other side
    except OSError:
        return  # it has ended by itself


def _reason(error: Exception) -> str:
    match error:
        case TimeoutError():
            return "no answer in time"
        case ssl.SSLCertVerificationError():
            return f"its certificate is not valid: {error.verify_message}"
        case ssl.SSLError():
            return f"no TLS connection: {error.reason or 'the connection broke'}"
        case ConnectionRefusedError():
            return "the connection was refused"
        case OSError():
            return error.strerror or "the connection broke"
    return "the answer was not HTTP"
