"""A drive as its documents tell it, made ready to be drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.problem import Problem
from app.science.optimal.reading import read_problem

Over = Literal["time", "distance"]


@dataclass(frozen=True, slots=True)
class DrawnDrive:
    """An answer with the problem it answers, and what was asked about it later.

    Attributes
    ----------
    answer : mapping
        As `Answer.document` tells it.
    problem : Problem
    name : str
        By which the drive is told from another one.
    comparison, front : mapping or None
        Of methods, and of fuel against an emission.
    """

    answer: Mapping[str, Any]
    problem: Problem
    name: str = "this drive"
    comparison: Mapping[str, Any] | None = None
    front: Mapping[str, Any] | None = None

    def has(self, name: str) -> bool:
        """Tell whether the trajectory has a column with numbers in it."""
        return name in self.answer["trajectory"] and bool(np.isfinite(self.column(name)).any())

    def column(self, name: str) -> FloatArray:
        """Return a column of the trajectory; NaN where it is null."""
        return np.array(self.answer["trajectory"][name], dtype=np.float64)

    def costate(self, name: str) -> FloatArray | None:
        """Return a costate along the trajectory, None where the answer has none of that name."""
        values = (self.answer.get("costates") or {}).get(name)
        return None if values is None else np.array(values, dtype=np.float64)

    @property
    def multiplier_w(self) -> float:
        """What a second is worth, W."""
        return float(self.answer.get("multiplier_w") or 0.0)


def drawn_drive(
    answer: Mapping[str, Any],
    problem: Mapping[str, Any],
    *,
    name: str = "this drive",
    comparison: Mapping[str, Any] | None = None,
    front: Mapping[str, Any] | None = None,
) -> DrawnDrive:
    """Make a drive ready to be drawn.

    Parameters
    ----------
    answer : mapping
    problem : mapping
        As posed, with an engine that says what it burns in place of one that names a map.
    name : str
    comparison, front : mapping, optional

    Raises
    ------
    ProblemError
        When the problem is none.
    """
    plain = escape(name, quote=False)  # figures take tags in names for markup
    return DrawnDrive(answer, read_problem(problem), plain, comparison, front)
