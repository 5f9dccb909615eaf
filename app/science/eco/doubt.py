"""How sure a saving is: the car's resistances and the engine's model are varied, and the whole comparison with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Protocol

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.eco.fuel_model import FuelModel
from app.science.eco.ride import Burnt, Ride, burnt
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.optimal.problem import RADPS_PER_RPM, RoadLoad

DRAWS = 24
REGION_RPM, REGION_SHARE = 1000.0, 0.25
"""How far errors of a formula reach: engine speed, and torque as a share of the highest."""
ACROSS, REGIONS = 16, 16 * 8
OF_OWN_ERROR = 0.5
SEED = 4


@dataclass(frozen=True, slots=True)
class LoadDoubts:
    """Standard deviations of what the car's file says, as shares.

    The defaults are what a file filled in from papers is worth: a passenger and luggage more or less, other tyres, a
    roof rack.
    """

    mass_share: float = 0.04
    rolling_share: float = 0.12
    drag_share: float = 0.08


@dataclass(frozen=True, slots=True)
class Pair:
    """All scored driving, and all best drives, one after the other; with what was measured of the driven one."""

    driven: Ride
    measured_w: FloatArray | None
    best: Ride


class Known(Protocol):
    """What is known of an engine."""

    @property
    def model(self) -> FuelModel:
        """The likeliest."""

    def draws(self, rng: np.random.Generator, count: int) -> Sequence[FuelModel]:
        """Return models that could be as true."""

    def under(self, driven: Ride, measured_w: FloatArray | None, before: RoadLoad, after: RoadLoad) -> FuelModel:
        """Return what would be known of it if the car had other resistances."""


def doubts(
    pair: Pair, load: RoadLoad, known: Known, cells: EfficiencyMap, highest_nm: float, given: LoadDoubts
) -> dict[str, float]:
    """Return the standard deviation of the saving in percentage points, by source.

    Both drives keep their motion. That is right to first order, since a best drive's fuel doesn't change by what the
    drive itself changes. With each draw of the resistances the engine is learnt again: the fuel that was measured, for
    the map and on this trip, stays what it is.
    """
    rng = np.random.default_rng(SEED)
    by_load = []
    for mass, rolling, drag in rng.standard_normal((DRAWS, 3)):
        drawn = _drawn(load, given, mass, rolling, drag)
        again = known.under(pair.driven, pair.measured_w, load, drawn)
        by_load.append(saved_percent(burnt(pair.driven, drawn, again), burnt(pair.best, drawn, again), pair))
    by_engine = [
        saved_percent(burnt(pair.driven, load, drawn), burnt(pair.best, load, drawn), pair)
        for drawn in known.draws(rng, DRAWS)
    ]
    error = shape_error(known.model, cells), highest_nm
    by_shape = [_bent(pair, load, known.model, error, rng) for _ in range(DRAWS)]
    return {
        "road_load": float(np.std(by_load, ddof=1)),
        "engine_model": float(np.std(by_engine, ddof=1)),
        "map_shape": float(np.std(by_shape, ddof=1)),
    }


def fuel_share(driven: Ride, load: RoadLoad, known: Known) -> float:
    """Return how unsure the driven fuel is where none was measured, one standard deviation as a share of it."""
    drawn = known.draws(np.random.default_rng(SEED), DRAWS)
    taken = [float(burnt(driven, load, model).fuel_w @ driven.dt_s) for model in drawn]
    return float(np.std(taken, ddof=1) / np.mean(taken))


def shape_error(model: FuelModel, cells: EfficiencyMap) -> float:
    """Return how far regions of a map are from a model, as a share of the fuel.

    The scatter of single cells within a region averages out. Half of what the map's formula misses cells by that it was
    not shown is taken at least, since a trip's correction is a formula, too.
    """
    known = np.isfinite(cells.efficiency)
    if not known.any():
        return OF_OWN_ERROR * model.error_share
    highest = float(cells.nm[known].max())
    omega, torque, n = cells.rpm[known] * RADPS_PER_RPM, cells.nm[known], np.maximum(cells.n[known], 1)
    missed = omega * torque / cells.efficiency[known] / model.fuel_power_w(omega, torque) - 1.0
    _, index = np.unique(_region(omega, torque, highest), return_inverse=True)
    weight = np.bincount(index, n)
    mean = np.bincount(index, n * (missed - np.average(missed, weights=n))) / weight
    return max(float(np.sqrt(np.average(mean**2, weights=weight))), OF_OWN_ERROR * model.error_share)


def _bent(pair: Pair, load: RoadLoad, model: FuelModel, error: tuple[float, float], rng: np.random.Generator) -> float:
    """Return the saving with a chance error for each region of the engine's field, the same for both drives.

    ``error`` is its standard deviation as a share of the fuel, and the highest torque of the map.
    """
    share, highest = error
    took = [burnt(ride, load, model) for ride in (pair.driven, pair.best)]
    errors = share * rng.standard_normal(REGIONS)
    mine, theirs = (
        replace(one, fuel_w=one.fuel_w * (1.0 + np.where(one.pulls, errors[_of(ride, one, highest)], 0.0)))
        for ride, one in zip((pair.driven, pair.best), took, strict=True)
    )
    return saved_percent(mine, theirs, pair)


def _of(ride: Ride, took: Burnt, highest_nm: float) -> IntArray:
    return _region(np.nan_to_num(ride.engine_radps), np.nan_to_num(took.torque_nm), highest_nm)


def _region(omega: FloatArray, torque: FloatArray, highest_nm: float) -> IntArray:
    """Return the number of the region an operating point is in."""
    column = np.clip(omega / RADPS_PER_RPM // REGION_RPM, 0, ACROSS - 1).astype(np.int64)
    row = np.clip(torque / highest_nm // REGION_SHARE, 0, REGIONS // ACROSS - 1).astype(np.int64)
    return row * ACROSS + column


def saved_percent(driven: Burnt, best: Burnt, pair: Pair) -> float:
    """Return by how much the best drives take less, in percent of the driven fuel."""
    mine, theirs = driven.fuel_w @ pair.driven.dt_s, best.fuel_w @ pair.best.dt_s
    return float(100.0 * (1.0 - theirs / mine))


def joined(rides: list[Ride]) -> Ride:
    """Return rides one after the other."""
    return Ride(*(np.concatenate([getattr(ride, field.name) for ride in rides]) for field in fields(Ride)))


def _drawn(load: RoadLoad, given: LoadDoubts, mass: float, rolling: float, drag: float) -> RoadLoad:
    heavier = max(1.0 + given.mass_share * mass, 0.1)
    return replace(
        load,
        mass_kg=load.mass_kg * heavier,
        accelerated_mass_kg=load.accelerated_mass_kg * heavier,
        crr=load.crr * max(1.0 + given.rolling_share * rolling, 0.0),
        cd=load.cd * max(1.0 + given.drag_share * drag, 0.0),
    )
