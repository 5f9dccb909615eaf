"""Logs with request ids and without secrets, metrics without tenants."""

from __future__ import annotations

import logging
import re
import sys
from collections.abc import MutableMapping
from typing import Any

import structlog
from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram

from app.settings import Settings

SECRET_NAMES = re.compile(r"password|secret|token|cookie|authorization|api_key", re.IGNORECASE)
SECRET_TEXT = re.compile(r"(ponthy_[0-9a-f]{8}_|whsec_)[\w-]+|(://[^:/@\s]*:)[^@/\s]+(?=@)")


def without_secrets(_logger: object, _method: str, event: MutableMapping[str, Any]) -> MutableMapping[str, Any]:
    """Blot out values under telling names, and tokens and passwords that stand inside any text."""
    for key, value in event.items():
        if SECRET_NAMES.search(key):
            event[key] = "•••"
        elif isinstance(value, str):
            event[key] = SECRET_TEXT.sub(lambda found: f"{found[1] or found[2]}•••", value)
    return event


def configure_logging(settings: Settings) -> None:
    """Send all logs of the process, the libraries' too, to standard error in one form."""
    shared: list[structlog.typing.Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
    ]
    end: structlog.typing.Processor = (
        structlog.processors.JSONRenderer() if settings.log_json else structlog.dev.ConsoleRenderer(colors=False)
    )
    formatter = structlog.stdlib.ProcessorFormatter(
        foreign_pre_chain=shared,
        processors=[
            structlog.stdlib.ProcessorFormatter.remove_processors_meta,
            structlog.processors.format_exc_info,
            without_secrets,
            end,
        ],
    )
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(formatter)
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(settings.log_level.upper())
    for name in ("uvicorn", "uvicorn.error"):
        logging.getLogger(name).handlers.clear()
        logging.getLogger(name).propagate = True
    logging.getLogger("alembic").setLevel(logging.WARNING)  # our own line tells when a database is migrated
    logging.getLogger("uvicorn.access").disabled = True  # its lines hold query strings; ours hold paths only
    structlog.configure(
        processors=[*shared, structlog.stdlib.ProcessorFormatter.wrap_for_formatter],
        logger_factory=structlog.stdlib.LoggerFactory(),
        wrapper_class=structlog.stdlib.BoundLogger,
        cache_logger_on_first_use=False,
    )


class Metrics:
    """Counters of one process. Labels are routes, methods and statuses; never a fleet, a user or an id."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.requests = Counter(
            "ponthy_requests_total", "Requests answered.", ("method", "route", "status"), registry=self.registry
        )
        self.request_seconds = Histogram(
            "ponthy_request_seconds", "Time to answer a request.", ("method", "route"), registry=self.registry
        )
        self.jobs = Gauge("ponthy_jobs", "Jobs of all fleets by state.", ("state",), registry=self.registry)
        self.received_bytes = Counter(
            "ponthy_received_bytes_total", "Bytes received in request bodies.", registry=self.registry
        )
