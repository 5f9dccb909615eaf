"""An embedded or a server-sized Ponthy with real worker processes whose stages the test holds and releases."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from app.settings import Settings
from app.storage.resources import Resources
from tests.yards import Yard
from workers.supervisor import environment_of

CREW = Path(__file__).with_name("crew.py")


@dataclass
class WorkYard(Yard):
    """A yard with worker processes."""

    folder: Path
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def notes(self) -> str:
        """What the stages wrote; see crew.py."""
        return self.trip().notes

    def start_worker(self) -> subprocess.Popen[bytes]:
        """Start a worker process whose stages wait as long as the folder has a file ``hold-<stage>``."""
        environment = {**os.environ, **environment_of(self.resources.settings), "PONTHY_TEST_FOLDER": str(self.folder)}
        command = [sys.executable, "-W", "error", str(CREW)]
        with (self.folder / f"worker-{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(command, env=environment, stderr=log, stdout=log, start_new_session=True)
        self.processes.append(process)
        return process

    def hold(self, stage: str) -> Path:
        """Have this stage wait until the file that is returned is gone."""
        path = self.folder / f"hold-{stage}"
        path.touch()
        return path

    def is_held(self, job_id: str, stage: str) -> bool:
        """Whether a worker is in a stage and waits there."""
        return any(s.name == stage and s.detail == "held" for s in self.job(job_id).stages)

    def until(self, condition: Callable[[], bool], seconds: float = 60.0) -> None:
        """Wait for something to become true; fail with the workers' logs when it doesn't."""
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end or (self.processes and all(p.poll() is not None for p in self.processes)):
                logs = "\n".join(p.read_text()[-3000:] for p in sorted(self.folder.glob("worker-*.log")))
                pytest.fail(f"it did not happen within {seconds} s or all workers are dead; they say:\n{logs}")
            time.sleep(0.05)


@pytest.fixture
def yard(settings: Settings, tmp_path: Path) -> Iterator[WorkYard]:
    """Return a fleet with a car and a trip whose workers have short leases."""
    resources = Resources.open(settings.model_copy(update={"lease_s": 1.0, "redeliver_s": 0.3, "log_level": "debug"}))
    yard = WorkYard(resources, tmp_path)
    yield yard
    for process in yard.processes:
        process.send_signal(signal.SIGCONT)
        process.kill()
        process.wait()
    resources.close()
