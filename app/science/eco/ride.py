"""A drive as kinematics, and what it takes: the same sums for the driven trip and for the best drive."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.eco.fuel_model import FuelModel
from app.science.optimal.problem import RoadLoad

TURNING_RADPS = 5.0


@dataclass(frozen=True, slots=True)
class Ride:
    """A drive in short pieces, each array of shape (n,); values are means over the pieces.

    Attributes
    ----------
    t_s, dt_s : array
        Where a piece begins, and how long it is.
    distance_m, speed_mps, accel_mps2, sin_slope : array
    gear : int array
        0 where the engine isn't geared to the wheels.
    engine_radps : array
        NaN where it isn't known.
    cut : bool array
        True where no fuel was injected although the gear isn't known.
    """

    t_s: FloatArray
    dt_s: FloatArray
    distance_m: FloatArray
    speed_mps: FloatArray
    accel_mps2: FloatArray
    sin_slope: FloatArray
    gear: IntArray
    engine_radps: FloatArray
    cut: BoolArray

    def part(self, rows: slice | BoolArray) -> Ride:
        """Return some of the pieces."""
        return Ride(*(getattr(self, field.name)[rows] for field in fields(self)))


@dataclass(frozen=True, slots=True)
class Burnt:
    """What a ride takes, each array of shape (n,).

    Attributes
    ----------
    pulls : bool array
        True where the engine is geared to the wheels: it pulls, or holds back.
    torque_nm : array
        Of the engine, overrun included; NaN where it doesn't pull.
    fuel_w, unloaded_w : array
        Fuel power, and the share of it that keeps the engine turning while it pulls.
    engine_w, air_w, brake_w : array
        Power at the wheels from the engine, and what air and brakes take. Brakes are all that holds the car back
        beyond overrun.
    """

    pulls: BoolArray
    torque_nm: FloatArray
    fuel_w: FloatArray
    unloaded_w: FloatArray
    engine_w: FloatArray
    air_w: FloatArray
    brake_w: FloatArray


def burnt(ride: Ride, load: RoadLoad, model: FuelModel) -> Burnt:
    """Work out engine torque, brakes and fuel from the motion alone (Sebesta 2010, 1.16, solved for the thrust).

    Parameters
    ----------
    ride : Ride
    load : RoadLoad
    model : FuelModel

    Returns
    -------
    Burnt
        Where no gear is in and the car is not pulled, the engine idles.
    """
    v = ride.speed_mps
    air = load.drag_kgpm * v**2
    grip = load.rolling_n * np.sqrt(1.0 - ride.sin_slope**2)
    climb = load.mass_kg * load.gravity_mps2 * ride.sin_slope
    power = (load.accelerated_mass_kg * ride.accel_mps2 + air + grip + climb) * v
    turning = np.isfinite(ride.engine_radps) & (ride.engine_radps > TURNING_RADPS)
    pulls = turning & ((ride.gear > 0) | (power > 0.0))
    omega = np.where(pulls, ride.engine_radps, 1.0)
    torque = np.maximum(power / omega, model.overrun_nm(omega))
    engine = np.where(pulls, torque * omega, np.maximum(power, 0.0))
    idle = np.where(ride.cut, 0.0, model.idle_w)
    return Burnt(
        pulls=pulls,
        torque_nm=np.where(pulls, torque, np.nan),
        fuel_w=np.where(pulls, model.fuel_power_w(omega, torque), idle),
        unloaded_w=np.where(pulls, model.unloaded_w(omega), 0.0),
        engine_w=engine,
        air_w=air * v,
        brake_w=engine - power,
    )
