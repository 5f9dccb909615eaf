"""The rows of an eco-score: where a trip lost fuel, by cause, place, acceleration and cell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

__all__ = ["PARTS", "Acceleration", "CellLoss", "Estimate", "Loss", "Part", "Section", "Standing", "TableRow"]

Part = Literal["braking", "air", "working_points", "rolling_idle", "rest"]
PARTS: Mapping[Part, str] = {
    "braking": "Braked away",
    "air": "Faster through the air",
    "working_points": "Engine off its best working points",
    "rolling_idle": "Idling while the car rolled",
    "rest": "Not explained",
}


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
