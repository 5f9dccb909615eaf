"""What runs in the process of a worker."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Mapping
from functools import partial

import prometheus_client
from celery.exceptions import SecurityWarning

from app.observability import configure_logging
from app.settings import Settings
from app.storage.resources import Resources
from workers.beats import TIDY_EVERY_S, Beat, look_after_deliveries, look_after_jobs, tidy
from workers.celery_app import make_worker_app
from workers.pipeline import STAGES
from workers.running import Stage


def run_worker(settings: Settings, stages: Mapping[tuple[str, str], Stage] = STAGES) -> int:
    """Work off the queue, one task at a time, and look after jobs that lost their worker, until asked to stop.

    The process works itself, without a child: a child would outlive its parent when that is killed.
    """
    configure_logging(settings)
    if settings.worker_metrics_port is not None:
        prometheus_client.start_http_server(settings.worker_metrics_port)
    resources = Resources.open(settings)
    for twice_told in ("celery.worker.strategy", "celery.app.trace"):
        logging.getLogger(twice_told).setLevel(logging.WARNING)  # our own line tells more of each task
    # Celery warns of working as root because of pickled messages; ours are JSON and nothing else is accepted.
    warnings.simplefilter("ignore", SecurityWarning)
    worker = make_worker_app(settings, resources, stages).Worker(
        pool_cls="solo",
        concurrency=1,  # also how many messages are taken from the queue, so that no other worker waits for them
        loglevel=settings.log_level.upper(),
        quiet=True,
        without_gossip=True,
        without_mingle=True,
        without_heartbeat=True,
    )
    with (
        Beat("jobs", settings.redeliver_s / 2, partial(look_after_jobs, resources)),
        Beat("webhooks", settings.redeliver_s / 2, partial(look_after_deliveries, resources)),
        Beat("tidying", TIDY_EVERY_S, partial(tidy, resources)),
    ):
        worker.start()
    resources.close()
    return int(worker.exitcode or 0)
