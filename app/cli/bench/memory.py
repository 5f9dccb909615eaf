"""How much memory a process has needed."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def peak_memory_mb(process: int | str = "self") -> float:
    """Return the peak of a running process's memory so far, MB; NaN where the system doesn't tell.

    The system's account of child processes is no help: it begins with the parent's memory at the fork.
    """
    with suppress(OSError):
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return float(line.split()[1]) * 1024 / 1e6
    return float("nan")
