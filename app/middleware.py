"""What happens around every request: an id, a line in the log, a count, checks of its origin, headers of its answer."""

from __future__ import annotations

import re
import time

import structlog
from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.edge import API
from app.errors import PonthyError
from app.observability import Metrics
from app.problems import answer, unexpected
from app.security import check_host, check_origin, security_headers
from app.settings import Settings
from app.storage.base import new_id

REQUEST_ID = "X-Request-Id"
GIVEN_ID = re.compile(r"[0-9A-Za-z-]{8,64}")

log = structlog.get_logger("ponthy.requests")


class Edge:
    """ASGI middleware around the whole application.

    Parameters
    ----------
    app : ASGIApp
    settings : Settings
    metrics : Metrics
    streamed : re.Pattern
        Paths whose handlers take bodies of any length, piece by piece; anywhere else a long body is refused.
    """

    def __init__(self, app: ASGIApp, settings: Settings, metrics: Metrics, streamed: re.Pattern[str]) -> None:
        self._app = app
        self._settings = settings
        self._metrics = metrics
        self._streamed = streamed
        self._headers = security_headers(settings)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        room = None if self._streamed.fullmatch(scope["path"]) else self._settings.max_body_bytes
        exchange = Exchange(scope, receive, send, self._headers, room)
        with structlog.contextvars.bound_contextvars(request_id=exchange.request_id):
            try:
                await self._checked(scope, exchange.receive, exchange.send)
            except Exception as error:  # noqa: BLE001 - the last resort: whatever it was, it is answered and logged
                reply = unexpected(Request(scope), error)
                if exchange.status is None:
                    await reply(scope, exchange.receive, exchange.send)
            finally:
                self._note(exchange)

    async def _checked(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = dict(Headers(scope=scope))
        try:
            check_host(self._settings, headers.get("host"))
            check_origin(self._settings, scope["method"], headers)
        except PonthyError as error:
            await answer(error, Request(scope))(scope, receive, send)
            return
        await self._app(scope, receive, send)

    def _note(self, exchange: Exchange) -> None:
        scope, seconds = exchange.scope, time.perf_counter() - exchange.started
        route, status = _template(scope), exchange.status or 500
        method = scope["method"] if scope["method"].isalpha() and len(scope["method"]) < 10 else "other"
        self._metrics.received_bytes.inc(exchange.received)
        self._metrics.requests.labels(method, route, str(status)).inc()
        self._metrics.request_seconds.labels(method, route).observe(seconds)
        level = log.debug if route.startswith(("/health", "/static")) else log.info
        fleet_id = scope.get("state", {}).get("fleet_id")
        level("request", method=method, path=scope["path"], status=status, seconds=round(seconds, 4), fleet_id=fleet_id)


class Exchange:
    """One request and its answer on their way through the edge.

    Parameters
    ----------
    scope, receive, send
        Of the ASGI call.
    headers : dict
        Headers that the answer gets unless it has them.
    room : int or None
        Bytes that the body may have; None where it may have any number.
    """

    def __init__(self, scope: Scope, receive: Receive, send: Send, headers: dict[str, str], room: int | None) -> None:
        given = Headers(scope=scope).get(REQUEST_ID, "")
        self.request_id = given if GIVEN_ID.fullmatch(given) else new_id()
        self.scope = scope
        self.started = time.perf_counter()
        self.status: int | None = None
        self.received = 0
        self._receive = receive
        self._send = send
        self._headers = headers
        self._room = room

    async def receive(self) -> Message:
        """Take in the next piece of the body; refuse one too many."""
        message = await self._receive()
        self.received += len(message.get("body", b""))
        if self._room is not None and self.received > self._room:
            raise HTTPException(413, f"A body here is {self._room} bytes long at most.")
        return message

    async def send(self, message: Message) -> None:
        """Send a piece of the answer, its beginning with our headers."""
        if message["type"] == "http.response.start":
            self.status = message["status"]
            headers = MutableHeaders(scope=message)
            headers[REQUEST_ID] = self.request_id
            for name, value in self._headers.items():
                headers.setdefault(name, value)
            if self.scope["path"].startswith(f"{API}/"):
                headers.setdefault("Cache-Control", "no-store")
        await self._send(message)


def _template(scope: Scope) -> str:
    """Return the route a request took, as it is declared: few enough to count by, and nobody's identifier in it."""
    route: str | None = getattr(scope.get("route"), "path", None)
    if route is None:
        return "unmatched"
    return API + route if scope["path"].startswith(f"{API}/") else route
