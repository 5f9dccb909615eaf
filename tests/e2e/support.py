"""What the browser's tests share: files of a drive, a watch over a page, and patience."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from playwright.sync_api import BrowserContext, ConsoleMessage, Page

ROOT = Path(__file__).resolve().parents[2]
PERSON, PASSWORD = "driver@example.org", "a long enough secret"
START_S = 90.0
PATIENCE_S = 120.0


@dataclass(frozen=True)
class Drive:
    """Files of a drive with the virtual car."""

    image: Path
    car_xml: Path
    elevation_csv: Path


@dataclass
class Watch:
    """What went wrong in a page without being seen: errors, refusals, requests to elsewhere."""

    host: str
    faults: list[str] = field(default_factory=list)
    expected: list[str] = field(default_factory=list)

    def expect(self, pattern: str) -> None:
        """Let console errors pass that match a pattern, because the test provokes them."""
        self.expected.append(pattern)

    def on(self, context: BrowserContext) -> None:
        """Note what happens in every page of a context."""
        context.on("console", self._console)
        context.on("weberror", lambda error: self.faults.append(f"uncaught: {error.error}"))
        context.on("request", lambda request: self._request(request.url))

    def _console(self, message: ConsoleMessage) -> None:
        refused = "Content Security Policy" in message.text
        if message.type == "error" or refused:
            self.faults.append(f"console: {message.text} ({message.location.get('url', '')})")

    def _request(self, url: str) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("data", "blob") and parts.netloc != self.host:
            self.faults.append(f"asked another host: {url}")

    def unexpected(self) -> list[str]:
        """Return the faults that no test provoked."""
        return [fault for fault in self.faults if not any(re.search(pattern, fault) for pattern in self.expected)]


def eventually(check: Callable[[], Any], what: str, seconds: float = PATIENCE_S) -> Any:
    """Poll until a check gives something true, and return it (a page's own waiting is refused by the policy)."""
    until = time.monotonic() + seconds
    while not (result := check()):
        assert time.monotonic() < until, f"waited {seconds:.0f} s for {what}"
        time.sleep(0.1)
    return result


def api(page: Page, path: str) -> Any:
    """Ask the API as the page would."""
    answer = page.request.get(f"/api/v1/{path}")
    assert answer.ok, answer.text()
    return answer.json()


@dataclass(frozen=True)
class Uploaded:
    """A car and its first trip, brought in through the pages."""

    car_id: str
    trip_id: str


@contextmanager
def running_ponthy(data: Path, **settings: str) -> Iterator[str]:
    """Run a Ponthy on a folder and a free port, and give its address."""
    command = [sys.executable, "-m", "app.cli", "up", "--port", "0", "--data", str(data), "--workers", "1"]
    environment = {"NUMBA_CACHE_DIR": str(ROOT / ".cache" / "numba"), **os.environ, **settings}
    lines: list[str] = []
    with (data.parent / f"{data.name}.log").open("w+") as log:
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=log, text=True)
        assert process.stdout is not None
        threading.Thread(target=lines.extend, args=(process.stdout,), daemon=True).start()
        try:
            until = time.monotonic() + START_S
            while not (found := re.search(r"Ponthy is at (http://\S+) ", "".join(lines))):
                log.seek(0)
                assert process.poll() is None, f"Ponthy ended at once: {log.read()}"
                assert time.monotonic() < until, f"Ponthy did not say its address: {lines}"
                time.sleep(0.1)
            yield found[1]
        finally:
            process.terminate()
            process.wait(20)
            process.stdout.close()
