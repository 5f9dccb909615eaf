"""A trip's states as a ride, and its pieces between stops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.eco.result import NotScored
from app.science.eco.ride import TURNING_RADPS, Ride
from app.science.optimal.problem import RADPS_PER_RPM, RoadLoad
from app.science.vehicle.model import Vehicle

NEEDED = ("t_s", "distance_m", "speed_mps", "thrust_n", "pitch_rad", "fuel_power_w", "engine_speed_radps", "gear")
AT_REST_MPS = 1.0
CUT_SHARE = 0.3
"""Of the idle fuel: below it, nothing is being injected."""
CREEP = 1.02
PULLED_W = 2000.0
ELECTRIC_SHARE = 0.05
SELDOM = 0.02
HARDEST, HARDEST_SPARE = 0.999, 1.1
GENTLE_MPS2 = 1.5
SHORTEST_S, SHORTEST_M = 6.0, 60.0


@dataclass(frozen=True, slots=True)
class Driven:
    """A trip as it was driven.

    Attributes
    ----------
    ride : Ride
        One piece for each step of the states.
    measured_w : array, shape (n,)
        Fuel power that was measured; nothing of it where ``fuel_known`` is false.
    heading_rad : array, shape (n,)
        NaN where unknown.
    load : RoadLoad
        With the accelerated mass that the trip's moving time had on average.
    fuel_known : bool
    """

    ride: Ride
    measured_w: FloatArray
    heading_rad: FloatArray
    load: RoadLoad
    fuel_known: bool

    def measured_j(self, rows: slice | BoolArray) -> float:
        """Return the fuel energy measured over some pieces, J."""
        return float(self.measured_w[rows] @ self.ride.dt_s[rows])


def driven_trip(columns: Mapping[str, FloatArray], vehicle: Vehicle, idle_w: float) -> Driven:
    """Return a trip as a ride.

    Accelerations come from the thrust, the slope and the car's resistances as the observer has them, with the mass
    that its gear accelerates; so no speed is differentiated.

    Parameters
    ----------
    columns : mapping
        Those of ``states.parquet``, NaN where unknown.
    vehicle : Vehicle
    idle_w : float

    Raises
    ------
    NotScored
        When a column is missing, or the trip tells nothing of the engine's speed.
    """
    missing = [name for name in NEEDED if name not in columns]
    if missing:
        raise NotScored(f"The trip's states lack {', '.join(missing)}; process the trip again.")
    t, v, pitch = columns["t_s"], columns["speed_mps"], columns["pitch_rad"]
    _known(columns)
    _propelled(columns)
    _geared(columns)
    gear = np.nan_to_num(columns["gear"]).astype(np.int64)
    heavy = np.array([vehicle.accelerated_mass_kg(k) for k in range(len(vehicle.gear_ratios) + 1)])[gear]
    grip = vehicle.mass_kg * vehicle.gravity_mps2 * (vehicle.crr * np.cos(pitch) + np.sin(pitch))
    accel = (columns["thrust_n"] - vehicle.drag_area_kgpm * v**2 - grip) / heavy
    fuel = np.nan_to_num(columns["fuel_power_w"])
    fuel_known = bool((fuel > 0.0).any())
    omega = columns["engine_speed_radps"]
    ratio = np.array([np.nan, *vehicle.gear_ratios])[gear] / vehicle.wheel_radius_m
    moving = v > AT_REST_MPS
    if not moving.any():
        raise NotScored("The car never moves faster than 1 m/s on this trip; there is no driving to score.")
    ride = Ride(
        t_s=t[:-1],
        dt_s=np.diff(t),
        distance_m=columns["distance_m"][:-1],
        speed_mps=_mean(v),
        accel_mps2=_mean(accel),
        sin_slope=_mean(np.sin(pitch)),
        gear=gear[:-1],
        engine_radps=np.where(gear[:-1] > 0, ratio[:-1] * _mean(v), omega[:-1]),
        cut=_mean(fuel) < CUT_SHARE * idle_w if fuel_known else omega[:-1] < TURNING_RADPS,
    )
    heading = columns.get("heading_rad", np.full(len(t), np.nan))
    load = _load(vehicle, float(heavy[moving].mean()))
    return Driven(ride, np.maximum(_mean(fuel), 0.0), heading[:-1], load, fuel_known)


def _propelled(columns: Mapping[str, FloatArray]) -> None:
    """Refuse trips on which something else than the engine drives the car."""
    pulled = (columns["thrust_n"] * columns["speed_mps"] > PULLED_W) & (columns["speed_mps"] > AT_REST_MPS)
    still = pulled & (columns["engine_speed_radps"] < TURNING_RADPS)
    share = float(still.sum()) / max(float(pulled.sum()), 1.0)
    if share > ELECTRIC_SHARE:
        raise NotScored(
            f"The engine stands still in {100.0 * share:.0f} % of the driving that takes power, so a motor drives the "
            "car, too. Its battery's energy isn't measured, and fuel alone doesn't tell what a drive took."
        )


def lowest_rpm(driven: Driven) -> float:
    """Return the engine speed that the driver hardly ever went below with a gear in, rpm."""
    return float(np.quantile(_in_gear(driven), SELDOM)) / RADPS_PER_RPM


def highest_rpm(driven: Driven) -> float:
    """Return the highest engine speed with a gear in, rpm."""
    return float(_in_gear(driven).max()) / RADPS_PER_RPM


def slowest_mps(vehicle: Vehicle, rpm: float) -> float:
    """Return the speed from which on a drive is compared: a little above the lowest that first gear takes."""
    return max(AT_REST_MPS, CREEP * rpm * RADPS_PER_RPM * vehicle.wheel_radius_m / max(vehicle.gear_ratios))


def brakes_n(driven: Driven, brake_w: FloatArray) -> float:
    """Return what the driver made the brakes do at most, N; some of it may be noise, so not the very most.

    Parameters
    ----------
    driven : Driven
    brake_w : array
        Power of the brakes at the pieces of the ride.
    """
    moving = driven.ride.speed_mps > AT_REST_MPS
    force = brake_w[moving] / driven.ride.speed_mps[moving]
    gentle = GENTLE_MPS2 * driven.load.mass_kg
    return max(HARDEST_SPARE * float(np.nanquantile(force, HARDEST)), gentle)


@dataclass(frozen=True, slots=True)
class Stretch:
    """Rows of a ride between two stops, first gear's lowest speed or more all along.

    Attributes
    ----------
    rows : slice
    reason : str
        Why it isn't worth a score; empty where it is.
    """

    rows: slice
    reason: str


def stretches(ride: Ride, slowest: float) -> list[Stretch]:
    """Return the driving between stops, in the order of time."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], ride.speed_mps >= slowest, [False]))))
    found = []
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        rows = slice(begin, end)
        seconds = float(ride.dt_s[rows].sum())
        metres = float(ride.speed_mps[rows] @ ride.dt_s[rows])
        short = seconds < SHORTEST_S or metres < SHORTEST_M
        found.append(Stretch(rows, f"It is only {seconds:.0f} s and {metres:.0f} m long." if short else ""))
    return found


def _known(columns: Mapping[str, FloatArray]) -> None:
    """Refuse trips without what a score stands on."""
    if not (columns["engine_speed_radps"] > TURNING_RADPS).any():
        raise NotScored("Nothing tells this trip's engine speed; log injector pulses or engine_speed_rpm.")


def _geared(columns: Mapping[str, FloatArray]) -> None:
    """Refuse trips without gears."""
    if not (columns["gear"] >= 1.0).any():
        raise NotScored(
            "No gear was recognised on this trip: the car's file needs its gear ratios (total, engine to wheel), or "
            "the trip an engine speed that follows the wheels' for some seconds in each gear."
        )


def _in_gear(driven: Driven) -> FloatArray:
    return driven.ride.engine_radps[(driven.ride.gear > 0) & (driven.ride.speed_mps > AT_REST_MPS)]


def _load(vehicle: Vehicle, accelerated_kg: float) -> RoadLoad:
    return RoadLoad(
        mass_kg=vehicle.mass_kg,
        accelerated_mass_kg=accelerated_kg,
        cd=vehicle.cd,
        frontal_area_m2=vehicle.frontal_area_m2,
        crr=vehicle.crr,
        air_density_kgpm3=vehicle.air_density_kgpm3,
        gravity_mps2=vehicle.gravity_mps2,
        wheel_radius_m=vehicle.wheel_radius_m,
    )


def _mean(values: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (values[1:] + values[:-1]))
