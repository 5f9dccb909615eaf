"""The engine a best drive is looked for with: the convex formula nearest to the corrected model."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.fuel_model import FuelModel
from app.science.engine.fitting.willans import WILLANS, nonnegative_least_squares
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine

LOOKS, LEAST_LOAD = 25, 0.1
JUST_ABOVE = 0.999


def engine_near(
    model: FuelModel, rpm: tuple[float, float], full_load: tuple[tuple[float, float], ...]
) -> PolynomialEngine:
    """Return the Willans model nearest to a model over the engine's field, by relative error.

    A convex formula has a best drive without pulses. The lowest torque is the weakest overrun at any engine speed.

    Parameters
    ----------
    model : FuelModel
    rpm : (lowest, highest)
    full_load : tuple of (rpm, Nm)
    """
    omega, torque = field(rpm, full_load)
    wanted = model.fuel_power_w(omega, torque)
    columns = WILLANS.columns(omega, torque) / wanted[:, np.newaxis]
    size = np.sqrt(np.sum(columns**2, axis=0))
    found = nonnegative_least_squares(columns / size, np.ones(len(wanted))) / size
    near = FuelModel(found, model.idle_w, model.error_share, model.cell_rpm, model.cell_nm, model.rpm)
    lowest = JUST_ABOVE * float(near.overrun_nm(np.linspace(*rpm, 101) * RADPS_PER_RPM).max())
    return PolynomialEngine(
        terms=WILLANS.terms,
        coefficients=tuple(found.tolist()),
        speed_rpm=rpm,
        torque_nm=(lowest, max(nm for _, nm in full_load)),
        full_load=full_load,
        idle_fuel_power_w=model.idle_w,
    )


def field(rpm: tuple[float, float], full_load: tuple[tuple[float, float], ...]) -> tuple[FloatArray, FloatArray]:
    """Return engine speeds (rad/s) and torques all over the field below full load."""
    line = np.array(full_load)
    share, speed = np.meshgrid(np.linspace(LEAST_LOAD, 1.0, LOOKS), np.linspace(*rpm, LOOKS))
    return (speed * RADPS_PER_RPM).ravel(), (share * np.interp(speed, line[:, 0], line[:, 1])).ravel()
