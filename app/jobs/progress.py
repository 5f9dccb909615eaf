"""What a stage of a job is given and gives back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from sqlalchemy.orm import Session


class Progress(Protocol):
    """Tells how far a stage is; raises when the stage should stop, so call it now and then."""

    def __call__(self, fraction: float, detail: str | None = None) -> None:
        """Say that a fraction (0 to 1) is done, and perhaps of what.

        Raises
        ------
        LeaseLost
            When another worker has the job by now; nothing more that this one does will count.
        JobCancelled
            When somebody asked to cancel the job.
        """


Store = Callable[[Session], None]
"""Writes a stage's result into the transaction that also marks the stage as finished, so that both happen or none."""


class LeaseLost(Exception):  # noqa: N818 - reads as the condition it names
    """The job belongs to somebody else by now."""


class JobCancelled(Exception):  # noqa: N818 - reads as the condition it names
    """Somebody asked to cancel the job."""
