"""Holding a job while one of its stages runs: a thread that renews the lease, and a voice for how far the stage is."""

from __future__ import annotations

import threading
import time
from types import TracebackType

import structlog

from app.jobs import service as jobs
from app.storage.database import Database

RENEWALS_PER_LEASE = 4
PROGRESS_EVERY_S = 0.3

log = structlog.get_logger(__name__)


class Hold:
    """A claimed stage, held as long as the ``with`` block runs.

    Parameters
    ----------
    database : Database
    fleet_id : str
    claim : Claim
    lease_s : float
        How long the job stays ours after the last sign of life.

    Attributes
    ----------
    detail : str or None
        What the stage said last, even if it was too soon after the last time to be written down.
    """

    def __init__(self, database: Database, fleet_id: str, claim: jobs.Claim, lease_s: float) -> None:
        self._database = database
        self._fleet_id = fleet_id
        self._claim = claim
        self._lease_s = lease_s
        self._ended = threading.Event()
        self._stop_reason: Exception | None = None
        self._told_at = 0.0
        self.detail: str | None = None
        self._thread = threading.Thread(target=self._renew_until_ended, name=f"lease {claim.job_id}", daemon=True)

    def __enter__(self) -> Hold:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()

    def progress(self, fraction: float, detail: str | None = None) -> None:
        """Say how far the stage is; see `app.jobs.progress.Progress`."""
        self.detail = detail
        if self._stop_reason is not None:
            raise self._stop_reason
        if time.monotonic() - self._told_at < PROGRESS_EVERY_S:
            return
        with self._database.transaction(self._fleet_id) as session:
            jobs.advance(session, self._claim, fraction, detail)
        self._told_at = time.monotonic()

    def _renew_until_ended(self) -> None:
        while not self._ended.wait(self._lease_s / RENEWALS_PER_LEASE):
            try:
                with self._database.transaction(self._fleet_id) as session:
                    jobs.renew(session, self._claim, self._lease_s)
            except (jobs.LeaseLost, jobs.JobCancelled) as reason:
                self._stop_reason = reason
                if isinstance(reason, jobs.LeaseLost):
                    return
            except Exception:
                log.warning("lease not renewed", job_id=self._claim.job_id, exc_info=True)
