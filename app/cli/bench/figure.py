"""One measured figure beside its reference, and the clock that takes both."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Figure:
    """What was measured.

    Attributes
    ----------
    name : str
        What, in words.
    value, reference : float
        Ours and the plain way's, both in ``unit``.
    unit : str
    reference_name : str
        What the plain way is.
    better : {"higher", "lower"}
        Whether a larger or a smaller value is the better one.
    goal : str
        What the project promises, in words; empty where it promises nothing.
    """

    name: str
    value: float
    unit: str
    reference: float
    reference_name: str
    better: Literal["higher", "lower"] = "lower"
    goal: str = ""

    @property
    def ratio(self) -> float:
        """How many times better ours is."""
        return self.value / self.reference if self.better == "higher" else self.reference / self.value


def best_seconds(work: Callable[[], object], repeats: int = 5) -> float:
    """Return the shortest wall time of some runs, seconds; the first run, which may compile, is not counted."""
    work()
    return min(timed(work) for _ in range(repeats))


def timed(work: Callable[[], object]) -> float:
    """Return the wall time of one run, seconds."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began
