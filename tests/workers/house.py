"""A real `up` on loopback: supervisor, web server and workers as processes, spoken to over HTTP."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.settings import Settings
from workers.supervisor import environment_of

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class House:
    """A Ponthy with its own data folder that can be started, killed and started again."""

    settings: Settings
    log: Path
    client: httpx.Client = field(default_factory=lambda: httpx.Client(timeout=60.0))
    process: subprocess.Popen[bytes] | None = None

    def start(self, *arguments: str) -> None:
        """Start `up` on a free port and wait until it answers."""
        compiled = {"NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", str(ROOT / ".cache" / "numba"))}
        environment = {**os.environ, **environment_of(self.settings), **compiled, "PONTHY_PORT": "0"}
        with self.log.open("ab") as log:
            command = [sys.executable, "-m", "workers", "up", *arguments]
            self.process = subprocess.Popen(command, env=environment, cwd=ROOT, stdout=log, stderr=log)
        before = self.log.stat().st_size if self.log.exists() else 0
        address = self.until(lambda: re.search(r"Ponthy is at (\S+)", self.log.read_text()[before:]), 90)
        self.client.base_url = httpx.URL(address[1])

    def children(self, word: str) -> list[int]:
        """Process ids of the running children of one kind."""
        assert self.process is not None
        listed = subprocess.run(
            ["ps", "-o", "pid=,args=", "--ppid", str(self.process.pid)], capture_output=True, text=True, check=False
        )
        return [int(line.split()[0]) for line in listed.stdout.splitlines() if f"workers {word}" in line]

    def kill_everything(self) -> None:
        """Kill the supervisor, which takes everybody with it."""
        assert self.process is not None
        family = [*self.children("web"), *self.children("worker")]
        self.process.kill()
        self.process.wait()
        self.until(lambda: not any(alive(pid) for pid in family), 5)

    def stop(self) -> int:
        """Ask it to end."""
        assert self.process is not None
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(30)

    def until(self, condition: Callable[[], Any], seconds: float = 180.0) -> Any:
        """Wait for something to become true and return it; fail with the log when it doesn't.

        The first trip of a fresh checkout may wait for a compiler.
        """
        end = time.monotonic() + seconds
        while not (found := condition()):
            if time.monotonic() > end:
                pytest.fail(f"it did not happen within {seconds} s; the log says:\n{self.log.read_text()[-5000:]}")
            time.sleep(0.05)
        return found

    def get(self, path: str, **query: Any) -> Any:
        """Return the JSON of an address below /api/v1."""
        answer = self.client.get(f"/api/v1{path}", params=query)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def change(self, method: str, path: str, status: int, **more: Any) -> Any:
        """Send a changing request and return its JSON."""
        answer = self.client.request(method, f"/api/v1{path}", **more)
        assert answer.status_code == status, answer.text
        return answer.json() if answer.content else None

    def send(self, car_id: str, filename: str, data: bytes) -> dict[str, Any]:
        """Send a file as a trip."""
        query = {"car_id": car_id, "filename": filename}
        received: dict[str, Any] = self.change("POST", "/trips", 202, params=query, content=data)
        return received

    def job_is_over(self, job_id: str) -> dict[str, Any] | None:
        job: dict[str, Any] = self.get(f"/jobs/{job_id}")
        return None if job["state"] in ("queued", "running") else job

    def events(self, path: str, seen: int | None = None) -> Iterator[dict[str, Any]]:
        """Give the events of a stream until it ends."""
        headers = {} if seen is None else {"Last-Event-ID": str(seen)}
        with self.client.stream("GET", f"/api/v1{path}", headers=headers, timeout=60) as answer:
            event: dict[str, Any] = {}
            for line in answer.iter_lines():
                if not line and event:
                    yield event
                    event = {}
                name, _, value = line.partition(": ")
                if name in ("id", "event"):
                    event[name] = int(value) if name == "id" else value
                elif name == "data":
                    event["data"] = json.loads(value)


def alive(pid: int) -> bool:
    """Whether a process is there and is more than a corpse."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] != "Z"
    except FileNotFoundError:
        return False
