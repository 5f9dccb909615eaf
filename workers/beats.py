"""What is done every now and then beside the work: looking after jobs and uploads that somebody left behind."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial

import structlog

from app.accounts import service as accounts
from app.batteries import service as batteries
from app.drives import service as drives
from app.jobs import service as jobs
from app.maps import service as maps
from app.storage.resources import Resources
from app.trips import service as trips
from app.webhooks import service as webhooks
from workers.announcing import announce

UPLOADS_EVERY_S = 300.0
TIDY_EVERY_S = 3600.0

log = structlog.get_logger(__name__)


class Beat:
    """A thread that does something again and again; when it goes wrong, the next round may go better.

    Parameters
    ----------
    name : str
        For the log.
    every_s : float
        Pause between two rounds; the first is done at once.
    action : callable
        One round.
    """

    def __init__(self, name: str, every_s: float, action: Callable[[], None]) -> None:
        self._name = name
        self._every_s = every_s
        self._action = action
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def __enter__(self) -> Beat:
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._action()
            except Exception:
                log.warning("a round went wrong", name=self._name, exc_info=True)
            self._ended.wait(self._every_s)


def look_after_jobs(resources: Resources) -> None:
    """Free the jobs of dead workers, and offer those again of which the queue has forgotten.

    Any number of processes may do this at once: each change is an UPDATE that only one of them succeeds with.
    """
    settings, database = resources.settings, resources.database
    with database.system_transaction(read_only=True) as session:
        if not jobs.need_care(session, settings.redeliver_s):
            return
    with database.system_transaction() as session:
        freed = jobs.recover(session, settings.attempts, gave_up=partial(announce, session))
    messages = resources.queue.size()
    with database.system_transaction() as session:
        sent = jobs.redeliver(session, settings.redeliver_s, messages=messages)
    if freed or sent:
        log.warning("looked after jobs", freed=freed, offered_again=sent)


def look_after_deliveries(resources: Resources) -> None:
    """Try what webhooks are still to be told: again after a failure, and what the queue has forgotten."""
    webhooks.deliver_due(resources)


def tidy(resources: Resources) -> None:
    """Forget the steps of jobs and deliveries that are long over, and remove files that no row refers to any more."""
    steps = jobs.forget_steps(resources.database, resources.settings.event_days)
    told = webhooks.forget(resources, resources.settings.event_days)
    with resources.database.system_transaction(read_only=True) as session:
        fleets = accounts.fleet_ids(session)
    slices = (trips, maps, drives, batteries)
    folders = sum(room.sweep(resources, fleet) for fleet in fleets for room in slices)
    if steps or folders or told:
        log.info("tidied up", steps=steps, folders=folders, deliveries=told)
