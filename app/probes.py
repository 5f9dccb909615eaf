"""Is it alive, is it ready, how busy is it: for whoever runs Ponthy."""

from __future__ import annotations

from collections.abc import Callable

import structlog
from fastapi import APIRouter, Request, Response
from fastapi.responses import JSONResponse, PlainTextResponse
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest
from pydantic import BaseModel, ConfigDict

from app.edge import OpenResources
from app.errors import PonthyError
from app.jobs import service as jobs
from app.observability import Metrics
from app.security import same_secret, secret_hash

router = APIRouter(tags=["probes"])
log = structlog.get_logger(__name__)


class Liveness(BaseModel):
    """The process answers."""

    model_config = ConfigDict(json_schema_extra={"example": {"status": "alive"}})

    status: str


class Readiness(BaseModel):
    """Whether each part that a request needs answers."""

    model_config = ConfigDict(
        json_schema_extra={"example": {"ready": True, "parts": {"database": True, "files": True, "queue": True}}}
    )

    ready: bool
    parts: dict[str, bool]


@router.get("/health/live")
def live() -> Liveness:
    """Say that the process answers."""
    return Liveness(status="alive")


@router.get("/health/ready", response_model=Readiness, responses={503: {"model": Readiness}})
def ready(resources: OpenResources) -> JSONResponse:
    """Say whether database, files and queue answer; 503 when one doesn't."""
    checks = {"database": resources.database.check, "files": resources.blobs.check, "queue": resources.queue.check}
    parts = {name: _answers(name, check) for name, check in checks.items()}
    state = Readiness(ready=all(parts.values()), parts=parts)
    return JSONResponse(state.model_dump(), 200 if state.ready else 503)


def _answers(name: str, check: Callable[[], None]) -> bool:
    try:
        check()
    except Exception:
        log.warning("not ready", part=name, exc_info=True)
        return False
    return True


@router.get("/metrics", response_class=PlainTextResponse)
def metrics(request: Request, resources: OpenResources) -> Response:
    """Give Prometheus its numbers: without a login on loopback, else for the configured token only."""
    settings = resources.settings
    if not settings.is_loopback:
        kept = "" if settings.metrics_token is None else settings.metrics_token.get_secret_value()
        sent = request.headers.get("authorization", "").removeprefix("Bearer ")
        if not kept or not same_secret(sent, secret_hash(kept)):
            message = "Send the token of PONTHY_METRICS_TOKEN as 'Authorization: Bearer …'."
            raise PonthyError("unauthenticated", message, 401, headers={"WWW-Authenticate": "Bearer"})
    known: Metrics = request.app.state.metrics
    with resources.database.system_transaction(read_only=True) as session:
        for state, count in jobs.counts(session).items():
            known.jobs.labels(state).set(count)
    return Response(generate_latest(known.registry), media_type=CONTENT_TYPE_LATEST)
