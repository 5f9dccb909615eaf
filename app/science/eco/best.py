"""The best drive of a section: posed as a route, solved on grids, and read back as a ride."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.eco.fuel_model import FuelModel
from app.science.eco.gears import regeared
from app.science.eco.ride import Ride
from app.science.optimal.answer import Trajectory
from app.science.optimal.problem import RADPS_PER_RPM, Infeasible, PolynomialEngine, Road, RoadLoad, Route, Transmission
from app.science.optimal.route.plan import Plan
from app.science.optimal.route.solving import solve
from app.science.progress import Progress

SLOWEST = 0.98
SAME_TIME_S = 1e-9
BRAKES_MPS2 = 1e-3
"""Slower by less than this than a car that rolls is rounding, not braking."""
SHIFT_COST_JPKG = 10.0
"""What the best drive pays for a change of gear, for each kilogram: so it changes no oftener than a driver would."""

Solver = Callable[[Route, Progress], Plan]


@dataclass(frozen=True, slots=True)
class Car:
    """What a best drive is looked for with.

    Attributes
    ----------
    load : RoadLoad
    engine : PolynomialEngine
    model : FuelModel
        By which the engine's fuel was made.
    ratios : tuple of float
        Total, first gear first.
    brake_n : float
        The most the brakes may do: what the driver made them do.
    freewheels : bool
        Whether the best drive may roll with the clutch open.
    """

    load: RoadLoad
    engine: PolynomialEngine
    model: FuelModel
    ratios: tuple[float, ...]
    brake_n: float
    freewheels: bool

    @property
    def shift_cost_j(self) -> float:
        """Charge for a change of gear, J."""
        return SHIFT_COST_JPKG * self.load.mass_kg

    def turning_radps(self, gear: IntArray, speed_mps: FloatArray) -> FloatArray:
        """Return the engine's speed in gears at speeds; NaN in neutral."""
        ratio = np.array([np.nan, *self.ratios])[gear]
        return np.asarray(ratio * speed_mps / self.load.wheel_radius_m)


def route(car: Car, road: Road, from_mps: float, to_mps: float, time_s: float) -> Route:
    """Return the problem: the same road, ends and time as driven.

    Brakes act in neutral, as a route has them. A car that may not roll there is charged for neutral as for the fastest
    turning engine, so that only braking is worth it; `ride_of_plan` charges the braking as what it is.
    """
    slowest = min(from_mps, to_mps, *road.speed_limit_mps)
    dear = float(car.model.unloaded_w(np.array([car.engine.speed_rpm[1] * RADPS_PER_RPM]))[0])
    return Route(
        load=car.load,
        engine=car.engine if car.freewheels else replace(car.engine, idle_fuel_power_w=dear),
        transmission=Transmission("gears", car.ratios, neutral=True, shift_cost_j=car.shift_cost_j),
        road=road,
        from_speed_mps=from_mps,
        to_speed_mps=to_mps,
        min_speed_mps=SLOWEST * slowest,
        max_time_s=time_s,
        brake_max_n=car.brake_n,
    )


def ride_of_plan(plan: Plan, car: Car, road: Road, start_s: float) -> Ride:
    """Return a drive by stages as a ride, in the gears that the fuel model likes best.

    Where it brakes, a gear is in: the car brakes as it did, and no fuel is injected.

    Parameters
    ----------
    plan : Plan
    car : Car
    road : Road
    start_s : float
        Time of the trip at which it begins.
    """
    length, before, after = np.diff(plan.edges_m), plan.speed_mps[:-1], plan.speed_mps[1:]
    v = 0.5 * (before + after)
    dt, accel = length / v, (after - before) * v / length
    middle = 0.5 * (plan.edges_m[1:] + plan.edges_m[:-1])
    slope = slope_at(road, middle)
    ride = Ride(
        t_s=start_s + np.concatenate(([0.0], np.cumsum(dt)[:-1])),
        dt_s=dt,
        distance_m=middle,
        speed_mps=v,
        accel_mps2=accel,
        sin_slope=slope,
        gear=plan.gear,
        engine_radps=car.turning_radps(plan.gear, v),
        cut=(plan.gear == 0) & (rolling_mps2(car.load, v, slope) > accel + BRAKES_MPS2),
    )
    return regeared(ride, car.load, car.engine, car.model, car.ratios, car.shift_cost_j)


def ride_of_trajectory(found: Trajectory, car: Car) -> Ride:
    """Return a trajectory on the level as a ride."""
    if not np.isfinite(found.t_s[-1] + found.distance_m[-1]):
        raise Infeasible("the car comes to a speed at which it would stay for ever.", "time_s")
    dt = np.diff(found.t_s)
    rows = np.flatnonzero(dt > SAME_TIME_S)
    gear = found.gear[rows]
    v = np.diff(found.distance_m)[rows] / dt[rows]
    return Ride(
        t_s=found.t_s[rows],
        dt_s=dt[rows],
        distance_m=found.distance_m[rows],
        speed_mps=v,
        accel_mps2=np.diff(found.speed_mps)[rows] / dt[rows],
        sin_slope=np.zeros(len(rows)),
        gear=gear,
        engine_radps=car.turning_radps(gear, v),
        cut=np.zeros(len(rows), np.bool_),
    )


def rolling_mps2(load: RoadLoad, speed_mps: FloatArray, sin_slope: FloatArray) -> FloatArray:
    """Return the acceleration of the car when nothing pulls and nothing brakes, m/s²."""
    against = load.drag_kgpm * speed_mps**2 + load.rolling_n * np.sqrt(1.0 - sin_slope**2)
    return np.asarray(-(against + load.mass_kg * load.gravity_mps2 * sin_slope) / load.accelerated_mass_kg)


def slope_at(road: Road, distance_m: FloatArray) -> FloatArray:
    """Return sin θ = dz/ds at places of a road."""
    nodes, height = np.array(road.distance_m), np.array(road.elevation_m)
    slope = np.diff(height) / np.diff(nodes)
    return np.asarray(slope[np.clip(np.searchsorted(nodes, distance_m, side="right") - 1, 0, len(slope) - 1)])


def plan_of(problem: Route, progress: Progress) -> Plan:
    """Solve a section on grids; the polish and the certificate of a single drive are left out."""
    return solve(problem, progress).plan
