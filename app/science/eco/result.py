"""What an eco-score says: how much less a trip could have taken, where it was lost, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from app.science.arrays import FloatArray
from app.science.eco.alongside import Along
from app.science.eco.rows import PARTS, Acceleration, CellLoss, Estimate, Loss, Section, Standing, TableRow
from app.science.errors import ScienceError

__all__ = [
    "PARTS", "Acceleration", "Along", "CellLoss", "EngineFrom", "Estimate", "Loss", "NotScored", "Section", "Standing",
    "TableRow", "TripScore",
]  # fmt: skip

EngineFrom = Literal["map", "trip", "ordinary"]


class NotScored(ScienceError):  # noqa: N818 - reads as the condition it names
    """A trip can't be compared with a best drive; the message says what is missing and what to do."""

    code = "not-scored"


@dataclass(frozen=True, slots=True)
class TripScore:
    """A trip beside the best drive over its own road, limits, stops and times.

    Attributes
    ----------
    score : Estimate
        100 × the best drive's fuel over the driven one's, both by the engine's model; 100 is the best drive.
    saved_percent : Estimate
        100 less the score.
    saved_l : Estimate
        That share of the fuel measured in the scored sections.
    driven_j, best_j : float
        Fuel by the engine's model over the scored sections.
    measured_j : float
        Fuel measured there.
    trip_l : float
        Fuel measured over the whole trip, stops included.
    scored_m, scored_s : float
    scored_percent : float
        Share of the trip's fuel that the scored sections took.
    doubts : mapping
        Standard deviation of the saving in percentage points, by source.
    parts : tuple of Loss
    cells : tuple of CellLoss
    elsewhere : tuple of Loss
        What was lost while the engine ran in no cell: ``braking`` and ``rolling``. With the cells this is the whole.
    sections : tuple of Section
    accelerations : tuple of Acceleration
    table : tuple of TableRow
        Table 4.2 over all accelerations.
    standing : Standing
    advice, assumptions, warnings : tuple of str
    along : Along
        Left out of the document.
    engine : EngineFrom
        What the engine's model rests on: the car's ``map``; where that carries no formula the ``trip`` itself; and
        where no fuel was measured either, an ``ordinary`` engine.
    fuel_measured : bool
        Whether the trip measured fuel; else all litres and all that is called measured are the engine's model's.
    """

    score: Estimate
    saved_percent: Estimate
    saved_l: Estimate
    driven_j: float
    best_j: float
    measured_j: float
    trip_l: float
    scored_m: float
    scored_s: float
    scored_percent: float
    doubts: Mapping[str, float]
    parts: tuple[Loss, ...]
    cells: tuple[CellLoss, ...]
    elsewhere: tuple[Loss, ...]
    sections: tuple[Section, ...]
    accelerations: tuple[Acceleration, ...]
    table: tuple[TableRow, ...]
    standing: Standing
    advice: tuple[str, ...]
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    along: Along
    engine: EngineFrom = "map"
    fuel_measured: bool = True

    def document(self) -> dict[str, Any]:
        """Return plain mappings, lists, texts and numbers, ready for JSON, without the arrays along the road."""
        return asdict(replace(self, along=Along.nothing())) | {"along": None}

    @classmethod
    def from_document(cls, document: Mapping[str, Any], columns: Mapping[str, FloatArray] | None = None) -> TripScore:
        """Return what `document` wrote, possibly after a way through JSON; with the arrays where they are given.

        Raises
        ------
        TypeError, KeyError
            When the document has other fields than this version writes.
        """
        kinds: dict[str, type[Any]] = {
            "parts": Loss,
            "cells": CellLoss,
            "elsewhere": Loss,
            "accelerations": Acceleration,
            "table": TableRow,
        }
        given = {**document, "along": Along.nothing() if columns is None else Along.from_columns(columns)}
        given |= {name: tuple(_made(kind, one) for one in document[name]) for name, kind in kinds.items()}
        given |= {name: Estimate(**document[name]) for name in ("score", "saved_percent", "saved_l")}
        given |= {name: tuple(document[name]) for name in ("advice", "assumptions", "warnings")}
        given["standing"] = Standing(**document["standing"])
        sections = (_made(Section, one) for one in document["sections"])
        given["sections"] = tuple(replace(s, parts=tuple(_made(Loss, p) for p in s.parts)) for s in sections)
        return cls(**given)


def _made(kind: type[Any], document: Mapping[str, Any]) -> Any:
    """Build a dataclass from a mapping, its lists again as tuples."""
    return kind(**{name: tuple(value) if isinstance(value, list) else value for name, value in document.items()})
