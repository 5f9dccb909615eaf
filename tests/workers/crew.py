"""A real worker process whose stages only wait and leave a note; the tests kill and freeze it."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from sqlalchemy.orm import Session

from app.jobs import service as jobs
from app.settings import Settings
from app.trips import repository
from workers.processes import run_worker
from workers.running import StageWork

FOLDER = Path(os.environ["PONTHY_TEST_FOLDER"])


def stage(work: StageWork) -> jobs.Store:
    """Wait while the test holds this stage, then add its name to the trip's notes."""
    name = work.claim.stage
    while (FOLDER / f"hold-{name}").exists():
        work.progress(0.5, "held")
        time.sleep(0.02)

    def store(session: Session) -> None:
        trip = repository.trip(session, str(work.claim.trip_id), lock=True)
        assert trip is not None
        trip.notes += f"{name} "

    return store


if __name__ == "__main__":
    sys.exit(run_worker(Settings(), {("trip", name): stage for name in jobs.TRIP_STAGES}))
