"""How far a long piece of work is, told while it works."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[float], None]
"""Is told the share that is done, from 0 to 1. What it raises ends the work and reaches the caller."""


def silent(_share: float) -> None:
    """Tell nobody."""


def between(progress: Progress, begin: float, end: float) -> Progress:
    """Return a progress whose 0 and 1 are ``begin`` and ``end`` of another one."""
    return lambda share: progress(begin + (end - begin) * share)
