"""The Celery application of a worker process, the base of all its tasks, and the tasks there are."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import structlog
from celery import Celery, Task
from celery.exceptions import WorkerShutdown
from celery.signals import worker_shutting_down
from prometheus_client import Counter, Histogram

from app.batteries import service as batteries
from app.drives import service as drives
from app.maps import service as maps
from app.settings import Settings
from app.storage.queue import broker_configuration
from app.storage.resources import Resources
from app.trips import service as trips
from app.webhooks import service as webhooks
from workers.running import Stage, run_next_stage

OUTCOMES = Counter("ponthy_tasks_total", "Tasks done by this worker.", ("task", "outcome"))
SECONDS = Histogram("ponthy_task_seconds", "Time a task took.", ("task",), buckets=(0.1, 0.5, 1, 5, 20, 60, 300, 1800))

log = structlog.get_logger("ponthy.tasks")


class PonthyTask(Task):  # type: ignore[misc]  # Celery has no types
    """Base of all tasks: binds the ids it was called with to the log, takes the time, counts outcomes.

    A task returns its outcome as a word. It is acknowledged when it is done, so that a message outlives a worker that
    stops in an orderly way; what happens to a job whose worker was killed is the reaper's business.
    """

    acks_late = True
    ignore_result = True
    busy = False

    def __call__(self, **kwargs: Any) -> str:
        """Run the task."""
        outcome, started = "error", time.perf_counter()
        PonthyTask.busy = True
        with structlog.contextvars.bound_contextvars(task=self.name, **kwargs):
            try:
                outcome = str(super().__call__(**kwargs))
            finally:
                PonthyTask.busy = False
                seconds = time.perf_counter() - started
                SECONDS.labels(self.name).observe(seconds)
                OUTCOMES.labels(self.name, outcome).inc()
                log.info("task", outcome=outcome, seconds=round(seconds, 3))
                structlog.contextvars.unbind_contextvars("stage", "trip_id", "attempt")
        return outcome


@worker_shutting_down.connect  # type: ignore[untyped-decorator]  # Celery has no types
def leave_at_once_when_idle(**_signal: Any) -> None:
    """End a worker that has nothing to do right away; Celery alone would wait for the queue for some seconds more."""
    if not PonthyTask.busy:
        raise WorkerShutdown(0)


def make_worker_app(settings: Settings, resources: Resources, stages: Mapping[tuple[str, str], Stage]) -> Celery:
    """Return the Celery application with which a worker process serves the queue."""
    celery = Celery("ponthy", task_cls=PonthyTask, set_as_current=False)
    celery.conf.update(
        broker_configuration(settings),
        accept_content=["json"],
        broker_connection_retry_on_startup=True,
        task_ignore_result=True,
        worker_enable_remote_control=False,
        worker_hijack_root_logger=False,
        worker_prefetch_multiplier=1,
        worker_redirect_stdouts=False,
        worker_send_task_events=False,
    )

    @celery.task(name="ponthy.stage")  # type: ignore[untyped-decorator]  # Celery has no types
    def stage(fleet_id: str, job_id: str) -> str:
        """Run the next stage of a job."""
        return run_next_stage(resources, fleet_id, job_id, stages)

    @celery.task(name="ponthy.sweep")  # type: ignore[untyped-decorator]  # Celery has no types
    def sweep(fleet_id: str) -> str:
        """Remove the files of what was deleted or replaced."""
        trips.sweep(resources, fleet_id)
        maps.sweep(resources, fleet_id)
        drives.sweep(resources, fleet_id)
        batteries.sweep(resources, fleet_id)
        return "swept"

    @celery.task(name="ponthy.deliver")  # type: ignore[untyped-decorator]  # Celery has no types
    def deliver(fleet_id: str, delivery_id: str) -> str:
        """Try to tell a webhook of an event."""
        return webhooks.deliver(resources, fleet_id, delivery_id)

    return celery
