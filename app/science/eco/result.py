"""What an eco-score says: how much less a trip could have taken, where it was lost, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from app.science.arrays import FloatArray
from app.science.eco.alongside import Along
from app.science.errors import ScienceError

__all__ = [
    "PARTS", "Acceleration", "Along", "CellLoss", "EngineFrom", "Estimate", "Loss", "NotScored", "Section", "Standing",
    "TableRow", "TripScore",
]  # fmt: skip

EngineFrom = Literal["map", "trip", "ordinary"]
Part = Literal["braking", "air", "working_points", "rolling_idle", "rest"]
PARTS: Mapping[Part, str] = {
    "braking": "Braked away",
    "air": "Faster through the air",
    "working_points": "Engine off its best working points",
    "rolling_idle": "Idling while the car rolled",
    "rest": "Not explained",
}


class NotScored(ScienceError):  # noqa: N818 - reads as the condition it names
    """A trip can't be compared with a best drive; the message says what is missing and what to do."""

    code = "not-scored"


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number and its standard deviation."""

    value: float
    sd: float


@dataclass(frozen=True, slots=True)
class Loss:
    """One part of what was lost; all parts together are the whole.

    Attributes
    ----------
    name : str
        One of `PARTS`.
    energy_j, litres : float
        Below 0 where the best drive takes more in this part.
    percent : float
        Of what the scored driving took.
    """

    name: str
    energy_j: float
    litres: float
    percent: float


@dataclass(frozen=True, slots=True)
class CellLoss:
    """What was lost while the engine ran in one cell of the map.

    Attributes
    ----------
    rpm, nm : float
        Centre of the cell.
    seconds, litres : float
        How long it was there, and what it took.
    lost_l : float
        Below 0 where this working point did better than the best drive's at the same place.
    """

    rpm: float
    nm: float
    seconds: float
    litres: float
    lost_l: float


@dataclass(frozen=True, slots=True)
class Section:
    """The driving between two stops.

    Attributes
    ----------
    from_s, to_s, from_m, to_m : float
        Times and distances of the trip.
    scored : bool
    reason : str
        Why not; empty where scored.
    driven_j, best_j, bound_j : float or None
        Fuel by the engine's model; ``bound_j`` is what no drive can go below, where it is known. None where not scored.
    measured_j : float
        Fuel that the trip measured.
    best_s : float or None
        Time of the best drive, never longer than the driven one.
    shifts, best_shifts : int or None
        Changes of gear.
    verdict : str
        ``best found``, or ``as driven`` where no better drive was found than the driven one.
    parts : tuple of Loss
    """

    from_s: float
    to_s: float
    from_m: float
    to_m: float
    scored: bool
    reason: str
    measured_j: float
    driven_j: float | None = None
    best_j: float | None = None
    bound_j: float | None = None
    best_s: float | None = None
    shifts: int | None = None
    best_shifts: int | None = None
    verdict: str = ""
    parts: tuple[Loss, ...] = ()


@dataclass(frozen=True, slots=True)
class Acceleration:
    """One rise of the speed beside the drives that Pontryagin's principle gives (Sebesta 2010, Table 4.2).

    Energies are fuel by the engine's model. The driven one is brought to the level: what the road's rise took is
    subtracted at the price of a joule of work.

    Attributes
    ----------
    from_s, to_s, from_mps, to_mps, time_s, distance_m, rise_m : float
    style : str
        How it was driven, in a few words.
    shift_rpm : tuple of float
        Engine speeds at which the driver shifted up.
    driven_j : float
    free_j, free_s, free_m : float or None
        Best drive to the same speed in any time: energy, time, distance. None where the model gives none.
    same_time_j : float or None
        The best in the driven time.
    best_shift_rpm : tuple of float
        Engine speeds at which the drive in free time shifts up.
    free_percent, same_time_percent : float or None
        Difference to the driven energy, below 0 where it takes less.
    reason : str
        Why there is nothing to compare with.
    """

    from_s: float
    to_s: float
    from_mps: float
    to_mps: float
    time_s: float
    distance_m: float
    rise_m: float
    style: str
    shift_rpm: tuple[float, ...]
    driven_j: float
    free_j: float | None = None
    free_s: float | None = None
    free_m: float | None = None
    same_time_j: float | None = None
    best_shift_rpm: tuple[float, ...] = ()
    free_percent: float | None = None
    same_time_percent: float | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True)
class TableRow:
    """One row of the trip's Table 4.2: all its accelerations together.

    Attributes
    ----------
    style : str
        Driving style, in words.
    energy_kj : float
    percent : float or None
        Difference to the driven energy; None in the row of the driven one.
    """

    style: str
    energy_kj: float
    percent: float | None


@dataclass(frozen=True, slots=True)
class Standing:
    """The time at rest, which both drives share; its fuel is not in the score.

    Attributes
    ----------
    stops : int
    seconds, energy_j, litres : float
        ``litres`` is what an engine off at stops would have saved.
    """

    stops: int
    seconds: float
    energy_j: float
    litres: float


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
