"""Engines as they ordinarily are: what stands in where a car's map can't say what its engine burns.

Seven measured engines, each as the convex formula P_in / V = k₁ω + k₂ω² + aωτ + bωτ² with τ = T / V, V the displacement
in litres. Fitted by relative error to the maps of ADVISOR (NREL) from 900 to 4500 rpm, above a tenth of the highest
torque; the test beside this file fits them again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.correction import in_blocks, noise_variance
from app.science.eco.fuel_model import FuelModel
from app.science.eco.ride import Ride, burnt
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.fitting.willans import nonnegative_least_squares
from app.science.optimal.problem import RADPS_PER_RPM, RoadLoad
from app.science.vehicle.model import Vehicle

ENGINES = {
    "Geo 1.0 l petrol": (73.02, 0.0, 1.089, 0.01614),
    "Insight 1.0 l petrol": (34.78, 0.0347, 1.067, 0.01535),
    "Prius 1.5 l petrol": (23.95, 0.0095, 2.252, 0.0),
    "Saturn 1.9 l petrol": (37.24, 0.0, 2.133, 0.00484),
    "Caravan 3.0 l petrol": (11.21, 0.0105, 3.321, 0.00753),
    "VW 1.9 l diesel": (6.96, 0.1120, 2.387, 0.0),
    "Mercedes 1.7 l diesel": (8.66, 0.1060, 2.201, 0.00169),
}
"""k₁ in Nm of fuel for each litre, k₂ in Nm s, a, and b in l/Nm."""
MISSED = 0.1
"""By how much the formula misses the least well described of them, root mean square over its map."""
LITRES_PER_TONNE, LITRES_SHARE = 1.2, 0.3
"""Displacement of a car whose file doesn't tell it, and its standard deviation as a share."""


@dataclass(frozen=True, slots=True)
class Ordinary:
    """An engine of which nothing was measured.

    Attributes
    ----------
    model : FuelModel
        Mean of the seven engines.
    litres, litres_share : float
        Displacement, and how sure it is.
    """

    model: FuelModel
    litres: float
    litres_share: float

    def between(self, lowest_rpm: float, highest_rpm: float) -> Ordinary:
        """Return the engine where it was driven."""
        return replace(self, model=replace(self.model, rpm=(lowest_rpm, highest_rpm)))

    def draws(self, rng: np.random.Generator, count: int) -> Sequence[FuelModel]:
        """Return engines that the car's could be: any of the seven, with a displacement drawn."""
        kinds = rng.integers(0, len(ENGINES), count)
        sizes = self.litres * np.exp(self.litres_share * rng.standard_normal(count))
        rows = np.array(list(ENGINES.values()))
        return [self.model.of(scaled(rows[kind], size)) for kind, size in zip(kinds, sizes.tolist(), strict=True)]

    def under(self, _driven: Ride, _measured_w: FloatArray | None, _before: RoadLoad, _after: RoadLoad) -> FuelModel:
        """Return the engine with other resistances of the car: the same, since no fuel was measured to learn from."""
        return self.model


def ordinary(vehicle: Vehicle, idle_w: float | None) -> Ordinary:
    """Return the engine of a car of which only the displacement may be known.

    Parameters
    ----------
    vehicle : Vehicle
    idle_w : float or None
        What was measured while idling; None where the formula is to say it.
    """
    known = vehicle.displacement_l
    litres = LITRES_PER_TONNE * vehicle.mass_kg / 1000.0 if known is None else known
    grid = CellGrid()
    start = FuelModel(np.zeros(5), 0.0, MISSED, grid.rpm, grid.nm, (0.0, 0.0))
    model = start.of(scaled(np.mean(list(ENGINES.values()), axis=0), litres))
    by_formula = float(model.unloaded_w(np.array([vehicle.idle_rpm * RADPS_PER_RPM]))[0])
    model = replace(model, idle_w=by_formula if idle_w is None else idle_w)
    return Ordinary(model, litres, LITRES_SHARE if known is None else 0.0)


def of_trip(start: Ordinary, ride: Ride, measured_w: FloatArray, load: RoadLoad) -> FuelModel:
    """Fit the formula to a trip's own working points, in blocks of ten seconds, with the seven engines as the prior.

    Parameters
    ----------
    start : Ordinary
    ride : Ride
        The driven trip.
    measured_w : array
        Fuel power at its pieces.
    load : RoadLoad

    Returns
    -------
    FuelModel
    """
    took = burnt(ride, load, start.model)
    rows = took.pulls & (np.nan_to_num(took.torque_nm) > 0.0)
    omega, torque = ride.engine_radps[rows], took.torque_nm[rows]
    columns = omega[:, np.newaxis] * np.stack((np.ones_like(omega), omega, torque, torque**2), axis=1)
    design, wanted = in_blocks(ride, rows, columns, measured_w[rows])
    noise = noise_variance(design, wanted, float(measured_w[rows].mean()))
    mean, covariance = _prior(start)
    root = np.linalg.inv(np.linalg.cholesky(covariance))
    whole = np.vstack((design / np.sqrt(noise), root))
    found = nonnegative_least_squares(whole, np.concatenate((wanted / np.sqrt(noise), root @ mean)))
    return start.model.of(found)


def scaled(engine: FloatArray | tuple[float, ...], litres: float) -> FloatArray:
    """Return k₁, k₂, a, b of an engine of a displacement."""
    k1, k2, a, b = engine
    return np.array([k1 * litres, k2 * litres, a, b / litres])


def _prior(start: Ordinary) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of k₁, k₂, a, b over the seven engines, the displacement's doubt included."""
    rows = np.array([scaled(engine, start.litres) for engine in ENGINES.values()])
    mean = rows.mean(axis=0)
    by_size = start.litres_share * mean * np.array([1.0, 1.0, 0.0, -1.0])
    return mean, np.cov(rows, rowvar=False) + np.outer(by_size, by_size)
