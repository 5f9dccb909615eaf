"""The gears of a best drive, chosen anew for its motion by the model that charges it.

The motion is looked for with a convex formula. With the motion known, gears can be chosen by any model, also by one
that would have a drive pulse: the cheapest sequence over the pieces of the ride, each change of gear with its charge.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.eco.fuel_model import FuelModel
from app.science.eco.ride import Ride, burnt
from app.science.optimal.fuel_checks import full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, RoadLoad

SLACK = 1e-6


def regeared(
    ride: Ride, load: RoadLoad, engine: PolynomialEngine, model: FuelModel, ratios: tuple[float, ...], charge_j: float
) -> Ride:
    """Return the same motion in the gears that burn least.

    Pieces in which no gear can give what the motion asks for keep theirs; so do those that roll in neutral, unless
    brakes act: then a gear is in, and no fuel is injected.

    Parameters
    ----------
    ride : Ride
    load : RoadLoad
    engine : PolynomialEngine
        Whose speeds and full load hold.
    model : FuelModel
        By which fuel is charged.
    ratios : tuple of float
        Total, first gear first.
    charge_j : float
        For a change of gear.
    """
    geared = (ride.gear > 0) | ride.cut
    columns = [_in_gear(ride, load, engine, model, ratio) for ratio in ratios]
    cost = np.stack(columns, axis=1)
    stuck = ~geared | ~np.isfinite(cost).any(axis=1)
    cost[stuck] = 0.0
    gear = np.where(stuck, ride.gear, _cheapest(cost, charge_j) + 1)
    turning = np.array([np.nan, *ratios])[gear] / load.wheel_radius_m * ride.speed_mps
    return replace(ride, gear=gear, engine_radps=turning, cut=ride.cut & stuck)


def _in_gear(ride: Ride, load: RoadLoad, engine: PolynomialEngine, model: FuelModel, ratio: float) -> FloatArray:
    """Return what each piece takes in a gear, J; infinity where the engine can't."""
    omega = ratio / load.wheel_radius_m * ride.speed_mps
    rpm = omega / RADPS_PER_RPM
    took = burnt(replace(ride, gear=np.ones_like(ride.gear), engine_radps=omega), load, model)
    low, high = engine.speed_rpm
    able = (rpm >= low * (1.0 - SLACK)) & (rpm <= high * (1.0 + SLACK))
    able &= took.torque_nm <= full_load_nm(engine, rpm) * (1.0 + SLACK)
    return np.where(able, took.fuel_w * ride.dt_s, np.inf)


def _cheapest(cost: FloatArray, charge_j: float) -> IntArray:
    """Choose one column for each row so that costs and charges for changes are least."""
    changes = charge_j * (1.0 - np.eye(cost.shape[1]))
    total = cost[0]
    came_from = np.zeros(cost.shape, np.int64)
    for row in range(1, len(cost)):
        candidates = total + changes
        came_from[row] = candidates.argmin(axis=1)
        total = candidates.min(axis=1) + cost[row]
    path = np.empty(len(cost), np.int64)
    path[-1] = int(total.argmin())
    for row in range(len(cost) - 1, 0, -1):
        path[row - 1] = came_from[row, path[row]]
    return path
