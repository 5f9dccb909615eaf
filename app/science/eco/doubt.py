"""How sure a saving is: the car's resistances and the engine's model are varied, and the whole comparison with them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.correction import Learnt, learn
from app.science.eco.fuel_model import FuelModel
from app.science.eco.ride import Burnt, Ride, burnt
from app.science.optimal.problem import RoadLoad

DRAWS = 24
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
    measured_w: FloatArray
    best: Ride


def doubts(
    pair: Pair, load: RoadLoad, model: FuelModel, learnt: Learnt, seen_nm: tuple[float, float], given: LoadDoubts
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
        scaled = model.rescaled(work(pair.driven, drawn, model) / work(pair.driven, load, model))
        took = burnt(pair.driven, drawn, scaled)
        again = learn(scaled, pair.driven, took, pair.measured_w, seen_nm).model
        by_load.append(saved_percent(burnt(pair.driven, drawn, again), burnt(pair.best, drawn, again), pair))
    by_engine = [
        saved_percent(burnt(pair.driven, load, drawn), burnt(pair.best, load, drawn), pair)
        for drawn in learnt.draws(rng, DRAWS)
    ]
    return {"road_load": float(np.std(by_load, ddof=1)), "engine_model": float(np.std(by_engine, ddof=1))}


def work(ride: Ride, load: RoadLoad, model: FuelModel) -> float:
    """Return the work of the pulling engine, J."""
    took = burnt(ride, load, model)
    return float(np.maximum(np.where(took.pulls, took.engine_w, 0.0), 0.0) @ ride.dt_s)


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
