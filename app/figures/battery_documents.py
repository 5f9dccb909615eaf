"""What figures of batteries are drawn from: an answer, a configuration, a history, as the service keeps them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.arrays import FloatArray

AS_PERCENT = 100.0


@dataclass(frozen=True, slots=True)
class HealthMark:
    """What one trip or file says of the battery.

    Attributes
    ----------
    at_s : float
        UTC, seconds since 1970.
    name : str
        Of the trip or file.
    soh, soh_sd : float or None
        Share of the rated capacity.
    estimate_id : str
        By which a page links it.
    """

    at_s: float
    name: str
    soh: float | None
    soh_sd: float | None
    estimate_id: str = ""


@dataclass(frozen=True, slots=True)
class LaboratoryMark:
    """A capacity that was measured in a laboratory, as a share of the rated one; ``at_s`` is UTC."""

    at_s: float
    soh: float
    soh_sd: float | None
    note: str = ""


@dataclass(frozen=True, slots=True)
class DrawnBattery:
    """A battery as its figures see it.

    Attributes
    ----------
    answer : mapping or None
        An estimate's answer, as `./ponthy battery --json` gives it.
    config : mapping or None
        The configuration it was made with.
    marks : sequence of HealthMark
        In order of time.
    tests : sequence of LaboratoryMark
    ageing : mapping or None
        The ageing document.
    threshold : float
        Share of the rated capacity at which the battery counts as worn out.
    told : tuple of array, shape (m,), or None
        Times on the answer's clock, seconds, and the state of charge that the car itself told, 0 to 1.
    """

    answer: Mapping[str, Any] | None = None
    config: Mapping[str, Any] | None = None
    marks: Sequence[HealthMark] = ()
    tests: Sequence[LaboratoryMark] = ()
    ageing: Mapping[str, Any] | None = None
    threshold: float = 0.8
    told: tuple[FloatArray, FloatArray] | None = None

    def has(self, name: str) -> bool:
        """Whether the answer's history holds a column with anything known in it."""
        column = self._history().get(name)
        return column is not None and any(value is not None for value in column)

    def column(self, name: str) -> FloatArray:
        """Return a column of the answer's history; NaN where it says nothing."""
        return as_array(self._history()[name])

    def _history(self) -> Mapping[str, Any]:
        return {} if self.answer is None else self.answer.get("history") or {}


def as_array(values: Sequence[float | None]) -> FloatArray:
    """Return a JSON list as an array; NaN for null."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Clock:
    """Times of a figure: from a moment on, in the unit that suits their span; ``title`` is the axis'."""

    zero_s: float
    unit_s: float
    title: str

    def at(self, t_s: FloatArray) -> FloatArray:
        """Return times as the figure shows them."""
        return (t_s - self.zero_s) / self.unit_s


def clock_of(t_s: FloatArray) -> Clock:
    """Return the clock of a figure over these times."""
    span = float(t_s[-1] - t_s[0])
    for unit_s, unit, least in ((86400.0, "days", 3.0), (3600.0, "h", 2.0), (60.0, "min", 5.0)):
        if span >= least * unit_s:
            return Clock(float(t_s[0]), unit_s, f"Time, {unit}")
    return Clock(float(t_s[0]), 1.0, "Time, s")


def time_axis(t_s: FloatArray) -> tuple[FloatArray, str]:
    """Return times as a figure shows them, and the axis' title."""
    clock = clock_of(t_s)
    return clock.at(t_s), clock.title
