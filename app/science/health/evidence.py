"""What one trip says of force against fuel: its windows as rows of a linear model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.roadload.windows import Regime, RoadLoadWindows

DEGREE = 5
SPEED_UNIT_RADPS = 300.0
POWER_UNIT_W = 1e5
FORCE_UNIT_N = 1e4
FUEL_SHARE = 0.005
"""Error of a window's force as a share of fuel power over speed: fuel and motion are not smoothed alike."""

POWERS = tuple((i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i))
"""Exponents of fuel power and engine speed in the engine's force."""
ENGINE = len(POWERS)
DRAG, ROLLING, BIAS, INERTIA, FORCE = range(ENGINE, ENGINE + 5)
TERMS = ENGINE + 2
"""What the usual is made of: the engine's force, and by how much drag and rolling resistance differ from the file's."""
COLUMNS = ENGINE + 5


@dataclass(frozen=True, slots=True)
class TripDesign:
    """Windows of a trip as rows of a linear model.

    Attributes
    ----------
    rows : array, shape (n, COLUMNS)
        The terms of the engine's force, P^i ω^j / v; then what drag, rolling resistance and a bias of the
        accelerometer are multiplied with, v², M (g cos θ + S_k v²) and M; what turning parts take of the force, over
        M; last the force at the wheels, N, that motion calls for with the car file's road load.
    variance : array, shape (n,)
        Of that force's error, as far as the observer knows it, N².
    engine_speed_radps, fuel_power_w : array, shape (n,)
    seconds : float
        Time the windows cover.
    mass_kg, bias_sd_mps2 : float
    """

    rows: FloatArray
    variance: FloatArray
    engine_speed_radps: FloatArray
    fuel_power_w: FloatArray
    seconds: float
    mass_kg: float
    bias_sd_mps2: float

    def gram(self, counted: BoolArray) -> FloatArray:
        """Return the weighted sums of products of all columns over the counted rows, shape (COLUMNS, COLUMNS)."""
        rows = self.rows[counted]
        return np.asarray((rows / self.variance[counted, None]).T @ rows)


def trip_design(windows: RoadLoadWindows, drag_area_kgpm: float, crr: float) -> TripDesign:
    """Take the windows in which the engine drives the car, whatever the force was.

    Parameters
    ----------
    windows : RoadLoadWindows
    drag_area_kgpm, crr : float
        The car's road load ½ ρ C_d A and C_rr, the same for all its trips.
    """
    chosen = (windows.kind == Regime.DRIVE) & np.isfinite(windows.fuel_power_w)
    chosen &= np.isfinite(windows.engine_speed_radps) & np.isfinite(windows.specific_force_mps2)
    w = windows.where(chosen)
    squared, normal_n = w.speed_squared_m2ps2, w.mass_kg * w.normal_mps2
    force_n = w.mass_kg * w.specific_force_mps2 + drag_area_kgpm * squared + crr * normal_n
    power, turning = w.fuel_power_w / POWER_UNIT_W, w.engine_speed_radps / SPEED_UNIT_RADPS
    terms = [power**i * turning**j * FORCE_UNIT_N / w.speed_mps for i, j in POWERS]
    inertia = w.specific_force_mps2 - w.acceleration_mps2 - w.gravity_mps2 * w.slope
    of_fuel_n = FUEL_SHARE * w.fuel_power_w / w.speed_mps
    return TripDesign(
        rows=np.stack([*terms, squared, normal_n, np.full(len(w), w.mass_kg), inertia, force_n], axis=1),
        variance=(w.mass_kg * w.specific_force_sd_mps2) ** 2 + of_fuel_n**2,
        engine_speed_radps=w.engine_speed_radps,
        fuel_power_w=w.fuel_power_w,
        seconds=float(w.length_s.sum()),
        mass_kg=w.mass_kg,
        bias_sd_mps2=w.bias_sd_mps2,
    )
