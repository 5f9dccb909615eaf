"""Child processes that are started again when they die, each time after a longer pause, and that die with us."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence

import structlog

FIRST_PAUSE_S = 0.5
LONGEST_PAUSE_S = 30.0
HEALTHY_AFTER_S = 60.0
PARENT = "PONTHY_PARENT_PID"
PR_SET_PDEATHSIG = 1

log = structlog.get_logger(__name__)


class Child:
    """A ``python -m workers …`` process that is kept running.

    Parameters
    ----------
    name : str
        For the log.
    arguments : sequence of str
        What follows ``python -m workers``.
    environment : mapping
        Environment variables besides our own.
    pass_fds : sequence of int
        File descriptors that the child inherits.
    """

    def __init__(
        self, name: str, arguments: Sequence[str], environment: Mapping[str, str], pass_fds: Sequence[int] = ()
    ) -> None:
        self.name = name
        self._command = [sys.executable, "-P", "-m", "workers", *arguments]
        self._environment = {**os.environ, **environment, PARENT: str(os.getpid())}
        self._pass_fds = tuple(pass_fds)
        self._process: subprocess.Popen[bytes] | None = None
        self._started_at = 0.0
        self._start_again_at = 0.0
        self._pause_s = FIRST_PAUSE_S

    def start(self) -> None:
        """Start the process; in a session of its own, so that Ctrl-C reaches it through us and in order."""
        self._process = subprocess.Popen(  # noqa: S603 - our own interpreter and module
            self._command, env=self._environment, pass_fds=self._pass_fds, start_new_session=True
        )
        self._started_at = time.monotonic()

    @property
    def status(self) -> int | None:
        """Exit status of the process, or None while it runs."""
        return None if self._process is None else self._process.poll()

    def keep_running(self) -> None:
        """Start the process again when it has died and its pause is over; call this now and then."""
        if self._process is not None and self._process.poll() is not None:
            lived_s = time.monotonic() - self._started_at
            self._pause_s = FIRST_PAUSE_S if lived_s > HEALTHY_AFTER_S else min(2 * self._pause_s, LONGEST_PAUSE_S)
            log.warning("a process died", name=self.name, status=self._process.returncode, again_in_s=self._pause_s)
            self._process, self._start_again_at = None, time.monotonic() + self._pause_s
        if self._process is None and time.monotonic() >= self._start_again_at:
            self.start()

    def ask_to_stop(self) -> None:
        """Send SIGTERM."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()

    def stop(self, until: float) -> None:
        """Wait for the end of the process up to a time of `time.monotonic`, then kill it."""
        if self._process is None:
            return
        try:
            self._process.wait(max(0.0, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def die_with_parent() -> None:
    """Have this process end when the one that started it does, however that one ends."""
    parent = int(os.environ.get(PARENT, "0"))
    if not parent:
        return
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    else:
        threading.Thread(target=_end_when_orphaned, args=(parent,), daemon=True).start()
    if os.getppid() != parent:  # it died before we were done asking
        os._exit(1)


def _end_when_orphaned(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)
