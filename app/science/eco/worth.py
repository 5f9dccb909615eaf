"""What speed is worth along a best drive: the costate λ_v of Pontryagin's principle, read from the drive itself."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.best import Car
from app.science.eco.losses import Drive
from app.science.optimal.fuel_checks import full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM

STEP_NM = 0.5
BRAKES_W = 500.0
AT_LIMIT_NM = 1.0


def costate(drive: Drive, car: Car) -> FloatArray:
    """Return λ_v at the pieces of a best drive, J s/m, shape (n,).

    Where torque is chosen freely, H is stationary in it, so a joule of kinetic energy is worth ∂P_in/∂T / ω joules of
    fuel, and a metre a second M_a v times that. Where the drive brakes, it is worth nothing. At full load and while
    rolling neither holds; there the worth of a joule is interpolated along the time (Sebesta 2010, 4.4, B.2.5).

    Parameters
    ----------
    drive : Drive
    car : Car

    Returns
    -------
    array
        NaN all along where no piece tells anything.
    """
    ride, took, model = drive.ride, drive.took, car.model
    omega, torque = ride.engine_radps, took.torque_nm
    brakes = took.brake_w > BRAKES_W
    with np.errstate(invalid="ignore"):
        chosen = took.pulls & ~brakes & (torque > model.overrun_nm(omega) + AT_LIMIT_NM)
        chosen &= torque < full_load_nm(car.engine, omega / RADPS_PER_RPM) - AT_LIMIT_NM
        step = model.fuel_power_w(omega, torque + STEP_NM) - model.fuel_power_w(omega, torque - STEP_NM)
        joule = np.where(chosen, step / (2.0 * STEP_NM * omega), 0.0)
    known = chosen | brakes
    if not known.any():
        return np.full(len(joule), np.nan)
    worth = np.interp(ride.t_s, ride.t_s[known], joule[known])
    return np.asarray(car.load.accelerated_mass_kg * ride.speed_mps * worth)
