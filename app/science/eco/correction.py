"""What the trip itself says of the engine's model: measured fuel less modelled fuel, over load and engine speed.

The convex formula of the map is what the best drive is looked for with. Where it misses, as at low load where a map has
no cells, both drives would be charged wrongly, and not alike, since they load the engine differently. So the measured
fuel of the trip corrects the formula for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.eco.fuel_model import FuelModel
from app.science.eco.ride import Burnt, Ride, burnt
from app.science.engine.cells import HIGHEST_EFFICIENCY
from app.science.optimal.problem import RoadLoad

KNOTS = (0.0, 0.08, 0.16, 0.25, 0.35, 0.5, 0.7, 1.0)
"""Load above overrun, as a share of the highest; at the first one, overrun, nothing is corrected."""
BLOCK_S = 10.0
OUTER = (0.05, 0.95)
LEAST_NOISE = 0.03
"""Share of the fuel by which ten seconds differ from any model."""
ALIKE, GROWTH = 0.3, 0.5
UNSEEN_SHARE = 0.3
"""Standard deviation of the formula's error where the map has no cells, of the fuel power."""


@dataclass(frozen=True, slots=True)
class Field:
    """Where a correction was learnt.

    Attributes
    ----------
    omega_mean, omega_low, omega_high : float
        Engine speeds, rad/s; beyond the outer ones the correction goes on as it is there.
    load : float
        Highest torque above overrun, Nm.
    """

    omega_mean: float
    omega_low: float
    omega_high: float
    load: float


@dataclass(frozen=True, slots=True)
class Corrected(FuelModel):
    """A fuel model with a correction on top.

    Attributes
    ----------
    weights : array, shape (2·knots − 2,)
        Nm of fuel: the correction's fuel power over engine speed at each knot but the first, then its growth with
        engine speed.
    field : Field
    """

    weights: FloatArray
    field: Field

    def fuel_power_w(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return fuel power, W, never less than the best engine there is would take."""
        plain = FuelModel.fuel_power_w(self, omega, torque)
        least = np.maximum(omega * torque, 0.0) / HIGHEST_EFFICIENCY
        return np.asarray(np.maximum(plain + basis(self, omega, torque, self.field) @ self.weights, least))


@dataclass(frozen=True, slots=True)
class Learnt:
    """A corrected model, and how sure the correction is.

    Attributes
    ----------
    model : Corrected
    covariance : array
        Of its weights.
    plain : FuelModel
        What was corrected.
    seen_nm : (lowest, highest)
        Torques at which the map has cells.
    """

    model: Corrected
    covariance: FloatArray
    plain: FuelModel
    seen_nm: tuple[float, float]

    def draws(self, rng: np.random.Generator, count: int) -> Sequence[FuelModel]:
        """Return models that could be as true as this one."""
        weights = rng.multivariate_normal(self.model.weights, self.covariance, count)
        return [replace(self.model, weights=row) for row in weights]

    def under(self, driven: Ride, measured_w: FloatArray | None, before: RoadLoad, after: RoadLoad) -> FuelModel:
        """Return what is learnt with other resistances of the car: the fuel that was measured stays what it is."""
        ratio = work(driven, after, self.plain) / work(driven, before, self.plain)
        scaled = self.plain.rescaled(ratio)
        return learn(scaled, driven, burnt(driven, after, scaled), measured_w, self.seen_nm).model


def basis(model: FuelModel, omega: FloatArray, torque: FloatArray, field: Field) -> FloatArray:
    """Return what the weights are multiplied by, W per Nm, shape (n, 2·knots − 2)."""
    load = np.clip((torque - model.overrun_nm(omega)) / field.load, 0.0, 1.0)
    hats = np.stack([np.interp(load, KNOTS, row) for row in np.eye(len(KNOTS))[1:]], axis=-1)
    hats = hats * omega[..., np.newaxis]
    growth = np.clip(omega, field.omega_low, field.omega_high) / field.omega_mean - 1.0
    return np.concatenate((hats, hats * growth[..., np.newaxis]), axis=-1)


def learn(
    model: FuelModel, ride: Ride, took: Burnt, measured_w: FloatArray | None, seen_nm: tuple[float, float]
) -> Learnt:
    """Fit the correction to a trip, in blocks of ten seconds, so that lags of the fuel measurement don't matter.

    Each weight is believed to be 0 within the formula's own error, which the map's cells tell where they are.

    Parameters
    ----------
    model : FuelModel
    ride, took : Ride, Burnt
        The driven trip, and what it took by the model.
    measured_w : array or None
        Measured fuel power at the pieces of the ride; None leaves the formula as it is, with its own error.
    seen_nm : (lowest, highest)
        Torques at which the map has cells.
    """
    rows = took.pulls & np.isfinite(took.torque_nm)
    omega, torque, dt = ride.engine_radps[rows], took.torque_nm[rows], ride.dt_s[rows]
    low, high = np.quantile(omega, OUTER).tolist()
    load = float((torque - model.overrun_nm(omega)).max())
    field = Field(float(np.average(omega, weights=dt)), low, high, load)
    columns = basis(model, omega, torque, field)
    prior = _prior(model, field, seen_nm)
    given = {name: getattr(model, name) for name in FuelModel.__slots__}
    if measured_w is None:
        return Learnt(Corrected(**given, weights=np.zeros(len(prior)), field=field), prior, model, seen_nm)
    design, missed = in_blocks(ride, rows, columns, measured_w[rows] - took.fuel_w[rows])
    typical_w = float(np.average(measured_w[rows], weights=dt))
    noise = noise_variance(design, missed, typical_w)
    precision = design.T @ design / noise + np.linalg.inv(prior)
    covariance = np.asarray(np.linalg.inv(precision), dtype=np.float64)
    weights = covariance @ design.T @ missed / noise
    return Learnt(Corrected(**given, weights=weights, field=field), covariance, model, seen_nm)


def in_blocks(ride: Ride, rows: BoolArray, columns: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return columns and what they are to explain, W, as sums over blocks of ten seconds.

    Parameters
    ----------
    ride : Ride
    rows : bool array
        The pieces that count.
    columns : array, shape (counted, k)
    wanted : array, shape (counted,)

    Returns
    -------
    tuple of array, shapes (blocks, k) and (blocks,)
        Weighted so that each block's noise is alike, W s½.
    """
    dt, t = ride.dt_s[rows], ride.t_s
    block = ((t[rows] - t[0]) / BLOCK_S).astype(np.int64)
    seconds = np.bincount(block, dt)
    used = seconds > 0.0
    root = 1.0 / np.sqrt(seconds[used])
    design = np.stack([np.bincount(block, dt * column)[used] * root for column in columns.T], axis=1)
    return design, np.bincount(block, dt * wanted)[used] * root


def work(ride: Ride, load: RoadLoad, model: FuelModel) -> float:
    """Return the work of the pulling engine, J."""
    took = burnt(ride, load, model)
    return float(np.maximum(np.where(took.pulls, took.engine_w, 0.0), 0.0) @ ride.dt_s)


def _prior(model: FuelModel, field: Field, seen_nm: tuple[float, float]) -> FloatArray:
    """Return the covariance of the formula's own error at the knots, Nm² of fuel, and of its growth over engine speed.

    Errors at neighbouring loads are alike: a formula doesn't miss up and down.
    """
    at = np.full(len(KNOTS) - 1, field.omega_mean)
    torque = model.overrun_nm(at) + field.load * np.array(KNOTS[1:])
    seen = (torque >= seen_nm[0]) & (torque <= seen_nm[1])
    share = np.where(seen, model.error_share, max(UNSEEN_SHARE, model.error_share))
    least = 0.5 * float(model.unloaded_w(at[:1])[0])
    sd = share * np.maximum(FuelModel.fuel_power_w(model, at, torque), least) / at
    knots = np.array(KNOTS[1:])
    alike = np.exp(-np.abs(knots[:, np.newaxis] - knots) / ALIKE) * np.outer(sd, sd)
    none = np.zeros_like(alike)
    return np.block([[alike, none], [none, GROWTH**2 * alike]])


def noise_variance(design: FloatArray, missed: FloatArray, typical_w: float) -> float:
    """Return what is left after a free fit, W² s; never less than ten seconds differ from any model."""
    left = missed - design @ np.linalg.lstsq(design, missed, rcond=None)[0]
    spare = max(len(missed) - design.shape[1], 1)
    return max(float(left @ left / spare), BLOCK_S * (LEAST_NOISE * typical_w) ** 2)
