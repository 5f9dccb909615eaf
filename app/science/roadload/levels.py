"""Efficiency levels before and after another road load, from sums that trips add up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.roadload.windows import RoadLoadWindows
from app.science.vehicle.model import Vehicle

SPEED_CELL_RPM = 250.0
LOAD_CELLS = 16
"""Cells of fuel per turn of the engine, up to a quarter above rated power; they do not move with the road load."""
POWER_W, POWER_RPM, EFFICIENCY = 80e3, 5500.0, 0.33
CELLS_PER_LOAD = 2
LEAST_CELL_S = 20.0
"""A cell has to be driven this long before it can be the best point."""
SUMS = ("seconds", "fuel_j", "kinetic_j", "drag_m3ps2", "rolling_jpkg", "turned_rad")


@dataclass(frozen=True, slots=True)
class EfficiencySums:
    """Sums over the propelled windows, arrays of shape (n,), one entry per cell.

    Attributes
    ----------
    rpm, load : tuple of int
        The cell's number along engine speed and fuel per turn.
    sums : array, shape (n, 6)
        `SUMS`: time; fuel energy; M_a v' + M g sin θ over the way, per kilogram; v² over the way; g cos θ + S_k v² over
        the way; the engine's angle.
    """

    rpm: tuple[int, ...]
    load: tuple[int, ...]
    sums: FloatArray

    def to_dict(self) -> dict[str, Any]:
        """Return the same as plain lists and numbers, ready for JSON."""
        return {"rpm": list(self.rpm), "load": list(self.load), "sums": self.sums.tolist()}

    @classmethod
    def from_dict(cls, plain: Mapping[str, Any]) -> EfficiencySums:
        """Return what `to_dict` was made from."""
        sums = np.array(plain["sums"], dtype=np.float64).reshape(-1, len(SUMS))
        return cls(tuple(plain["rpm"]), tuple(plain["load"]), sums)


@dataclass(frozen=True, slots=True)
class Resistance:
    """Mass, ½ ρ C_d A and C_rr."""

    mass_kg: float
    drag_area_kgpm: float
    crr: float


@dataclass(frozen=True, slots=True)
class BestPoint:
    """The cell that was best before, and what becomes of it: efficiency and torque before and after."""

    rpm: float
    before: float
    after: float
    nm_before: float
    nm_after: float


@dataclass(frozen=True, slots=True)
class AtLoad:
    """Efficiency before and after at one fuel per turn of the engine, by the mean fuel power there."""

    fuel_power_w: float
    before: float
    after: float


@dataclass(frozen=True, slots=True)
class Levels:
    """Efficiency before and after.

    Attributes
    ----------
    before, after : float
        Work over fuel of everything driven.
    best : BestPoint or None
        None where no cell was driven long enough.
    by_load : tuple of AtLoad
    """

    before: float
    after: float
    best: BestPoint | None
    by_load: tuple[AtLoad, ...]


def efficiency_sums(driven: RoadLoadWindows, vehicle: Vehicle) -> EfficiencySums:
    """Add up a trip's propelled windows by cell; those whose fuel is not known are left out."""
    w = driven.where(np.isfinite(driven.fuel_power_w) & (driven.fuel_power_w > 0.0))
    rpm = (w.engine_speed_radps * 30.0 / pi / SPEED_CELL_RPM).astype(np.int64)
    load = np.minimum(w.fuel_power_w / w.engine_speed_radps / _load_cell_j(vehicle), LOAD_CELLS - 1.0).astype(np.int64)
    way = w.speed_mps * w.length_s
    rows = np.column_stack(
        [
            w.length_s,
            w.fuel_power_w * w.length_s,
            w.specific_force_mps2 * way,
            w.speed_squared_m2ps2 * way,
            w.normal_mps2 * way,
            w.engine_speed_radps * w.length_s,
        ]
    )
    return _added(rpm * LOAD_CELLS + load, rows)


def added(trips: Sequence[EfficiencySums]) -> EfficiencySums:
    """Add trips up."""
    numbers = [np.array(trip.rpm, dtype=np.int64) * LOAD_CELLS + np.array(trip.load, dtype=np.int64) for trip in trips]
    return _added(
        np.concatenate([np.empty(0, np.int64), *numbers]),
        np.concatenate([np.empty((0, len(SUMS))), *(trip.sums for trip in trips)]),
    )


def _added(cell: Any, rows: FloatArray) -> EfficiencySums:
    cells, place = np.unique(cell, return_inverse=True)
    sums = np.zeros((len(cells), len(SUMS)))
    np.add.at(sums, place, rows)
    return EfficiencySums(tuple((cells // LOAD_CELLS).tolist()), tuple((cells % LOAD_CELLS).tolist()), sums)


def levels(found: EfficiencySums, before: Resistance, after: Resistance) -> Levels | None:
    """Return the efficiency with two road loads; None where no fuel was burned."""
    seconds, fuel = found.sums[:, 0], found.sums[:, 1]
    if not len(fuel) or fuel.sum() <= 0.0:
        return None
    work = [_work(found.sums, road) for road in (before, after)]
    first, second = work
    load = np.array(found.load) // CELLS_PER_LOAD
    by_load = [
        AtLoad(
            float(fuel[on].sum() / seconds[on].sum()),
            float(first[on].sum() / fuel[on].sum()),
            float(second[on].sum() / fuel[on].sum()),
        )
        for on in (load == one for one in np.unique(load))
        if seconds[on].sum() >= LEAST_CELL_S
    ]
    return Levels(
        float(first.sum() / fuel.sum()), float(second.sum() / fuel.sum()), _best(found, first, second), tuple(by_load)
    )


def _best(found: EfficiencySums, first: FloatArray, second: FloatArray) -> BestPoint | None:
    seconds, fuel, turned = found.sums[:, 0], found.sums[:, 1], found.sums[:, 5]
    long = seconds >= LEAST_CELL_S
    if not long.any():
        return None
    at = int(np.argmax(np.where(long, first / fuel, -1.0)))
    return BestPoint(
        rpm=(found.rpm[at] + 0.5) * SPEED_CELL_RPM,
        before=float(first[at] / fuel[at]),
        after=float(second[at] / fuel[at]),
        nm_before=float(first[at] / turned[at]),
        nm_after=float(second[at] / turned[at]),
    )


def _work(sums: FloatArray, road: Resistance) -> FloatArray:
    return np.asarray(road.mass_kg * (sums[:, 2] + road.crr * sums[:, 4]) + road.drag_area_kgpm * sums[:, 3])


def _load_cell_j(vehicle: Vehicle) -> float:
    """Return the width of a cell of fuel per radian, J."""
    power, rpm = vehicle.max_power_w or POWER_W, vehicle.max_power_rpm or POWER_RPM
    return power / EFFICIENCY / (rpm * pi / 30.0) * 1.25 / LOAD_CELLS
