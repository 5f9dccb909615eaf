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
        given = Headers(scope=scope).get(REQUEST_ID, "")
        request_id = given if GIVEN_ID.fullmatch(given) else new_id()
        started = time.perf_counter()
        status = 500
        begun = False
        room = None if self._streamed.fullmatch(scope["path"]) else self._settings.max_body_bytes

        async def counted_receive() -> Message:
            nonlocal room
            message = await receive()
            length = len(message.get("body", b""))
            self._metrics.received_bytes.inc(length)
            if room is not None:
                room -= length
                if room < 0:
                    raise HTTPException(413, f"A body here is {self._settings.max_body_bytes} bytes long at most.")
            return message

        async def send_with_headers(message: Message) -> None:
            nonlocal status, begun
            if message["type"] == "http.response.start":
                status, begun = message["status"], True
                headers = MutableHeaders(scope=message)
                headers[REQUEST_ID] = request_id
                for name, value in self._headers.items():
                    headers.setdefault(name, value)
                if scope["path"].startswith("/api/"):
                    headers.setdefault("Cache-Control", "no-store")
            await send(message)

        with structlog.contextvars.bound_contextvars(request_id=request_id):
            try:
                await self._checked(scope, counted_receive, send_with_headers)
            except Exception as error:  # noqa: BLE001 - the last resort: whatever it was, it is answered and logged
                reply = unexpected(Request(scope), error)
                if not begun:
                    await reply(scope, counted_receive, send_with_headers)
            finally:
                self._note(scope, status, time.perf_counter() - started)

    async def _checked(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = dict(Headers(scope=scope))
        try:
            check_host(self._settings, headers.get("host"))
            check_origin(self._settings, scope["method"], headers)
        except PonthyError as error:
            await answer(error, Request(scope))(scope, receive, send)
            return
        await self._app(scope, receive, send)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        route = _template(scope)
        method = scope["method"] if scope["method"].isalpha() and len(scope["method"]) < 10 else "other"
        self._metrics.requests.labels(method, route, str(status)).inc()
        self._metrics.request_seconds.labels(method, route).observe(seconds)
        level = log.debug if route.startswith(("/health", "/static")) else log.info
        fleet_id = scope.get("state", {}).get("fleet_id")
        level("request", method=method, path=scope["path"], status=status, seconds=round(seconds, 4), fleet_id=fleet_id)


def _template(scope: Scope) -> str:
    """Return the route a request took, as it is declared: few enough to count by, and nobody's identifier in it."""
    route: str | None = getattr(scope.get("route"), "path", None)
    if route is None:
        return "unmatched"
    return API + route if scope["path"].startswith(f"{API}/") else route
