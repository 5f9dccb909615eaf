"""Where the driven trip took more than the best drive: by cause, by place, and by cell of the map; all add up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.eco.result import PARTS
from app.science.eco.ride import Burnt, Ride
from app.science.eco.road import travelled_m


@dataclass(frozen=True, slots=True)
class Drive:
    """A section as a ride and what it takes."""

    ride: Ride
    took: Burnt

    @property
    def fuel_j(self) -> float:
        """Fuel energy, J."""
        return float(self.took.fuel_w @ self.ride.dt_s)

    @property
    def time_s(self) -> float:
        """Time, s."""
        return float(self.ride.dt_s.sum())


def joule_price(drives: Sequence[Drive]) -> float:
    """Return what a joule of the engine's work takes in some drives, J of fuel beyond what keeps the engine turning."""
    load = work = 0.0
    for drive in drives:
        took, dt = drive.took, drive.ride.dt_s
        pulling = in_cells(drive)
        load += float((took.fuel_w - took.unloaded_w)[pulling] @ dt[pulling])
        work += float(took.engine_w[pulling] @ dt[pulling])
    return load / work if work > 0.0 else 0.0


def parts(driven: Drive, best: Drive) -> dict[str, float]:
    """Split the difference in fuel, J.

    With p the price of a joule of work, W the engine's work, and W = braked + air + what both drives need alike:
    Δ fuel = p Δ braked + p Δ air + Δ(fuel while pulling − p W) + Δ fuel while rolling + the rest.
    """
    p = joule_price((driven, best))
    one, other = _sums(driven), _sums(best)
    change = {name: one[name] - other[name] for name in one}
    found = {
        "braking": p * change["brake"],
        "air": p * change["air"],
        "working_points": change["pulling"] - p * change["work"],
        "rolling_idle": change["rolling"],
        "rest": p * (change["work"] - change["brake"] - change["air"]),
    }
    return {name: found[name] for name in PARTS}


def _sums(drive: Drive) -> dict[str, float]:
    took, dt = drive.took, drive.ride.dt_s
    return {
        "brake": float(took.brake_w @ dt),
        "air": float(took.air_w @ dt),
        "work": float(took.engine_w @ dt),
        "pulling": float(took.fuel_w[took.pulls] @ dt[took.pulls]),
        "rolling": float(took.fuel_w[~took.pulls] @ dt[~took.pulls]),
    }


def lost_along(driven: Drive, best: Drive, accelerated_kg: float) -> FloatArray:
    """Return for each piece of the driven ride what was lost there, J; the sum is the whole difference.

    Speed that is in the car is worth its kinetic energy at the price of a joule of work; else a drive that speeds up
    later would seem to lose where the other one speeds up.
    """
    p = joule_price((driven, best))
    own, other = _profile(driven), _profile(best)
    share = own.edges_m / own.edges_m[-1] * other.edges_m[-1]
    worth = 0.5 * accelerated_kg * p
    mine = own.fuel_j - worth * own.speed_squared
    theirs = np.interp(share, other.edges_m, other.fuel_j) - worth * np.interp(
        share, other.edges_m, other.speed_squared
    )
    lost = np.diff(mine - theirs)
    return np.asarray(lost + (driven.fuel_j - best.fuel_j - lost.sum()) * driven.ride.dt_s / driven.time_s)


@dataclass(frozen=True, slots=True)
class _Profile:
    """Over the edges of a ride's pieces, each array of shape (n + 1,)."""

    edges_m: FloatArray
    fuel_j: FloatArray
    speed_squared: FloatArray


def _profile(drive: Drive) -> _Profile:
    ride = drive.ride
    edges = travelled_m(ride)
    half = 0.5 * ride.accel_mps2 * ride.dt_s
    begin, end = np.maximum(ride.speed_mps - half, 0.0), np.maximum(ride.speed_mps + half, 0.0)
    speed = np.concatenate((begin[:1], 0.5 * (begin[1:] + end[:-1]), end[-1:]))
    return _Profile(edges, np.concatenate(([0.0], np.cumsum(drive.took.fuel_w * ride.dt_s))), speed**2)


def in_cells(drive: Drive) -> BoolArray:
    """Tell where the engine pulls, so that it is in a cell of the map."""
    return np.asarray(drive.took.pulls & (np.nan_to_num(drive.took.torque_nm) > 0.0))
