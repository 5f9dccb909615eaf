"""Fuel from the power at the wheels alone, for cars whose engine speed nobody measured (after Sebesta 2010, 3.4).

A Willans line at the wheels: an engine that turns has its price, and each watt at the wheels another one. While the car
drives, with P the power at the wheels,

    P_fuel = max(c₀ + c₁ P + c₂ max(P, 0)², idle or overrun)

Below the creep speed the clutch or the converter slips, so that a force costs as if the car were as fast as that, and
an engine without load idles; above, it is dragged along and cut off, more or less. Gaining speed turns engine and
shafts faster, too, in a gear nobody knows: that is a share of the mass. A start from cold burns an energy on top that
dies out while the engine runs. All coefficients are at least zero, so the model is monotone and convex in P, and
beyond the largest power it was fitted to it goes on straight.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.wheel_power import (
    STANDING_MPS,
    DrivingCycle,
    RoadLoad,
    engine_runs,
    propulsion_n,
    stretches,
)

COLD_SHARE, COLD_SHARE_SD = 0.20, 0.10
"""What a start from cold at 24 °C adds to the fuel of its first 505 s: Taylor and Stewart 2001 (SAE 2001-01-0221)."""
COLD_SHARE_S = 505
COOLING_S = 3600.0
"""An assumption: a parked engine is about two thirds as cold after an hour as it will ever be."""
WARM_UP_S = 100.0
"""In which what a start adds falls to 37 %. First the catalyst is heated, then cold oil drags: one number for both."""
TERMS = ("idle", "overrun", "constant", "slope", "curvature")


@dataclass(frozen=True, slots=True)
class WheelFuelModel:
    """Coefficients with their standard deviations.

    Attributes
    ----------
    idle_w, overrun_w : float
        Fuel power while the car stands, and while it is faster than it creeps and drags its engine along.
    constant_w, slope, curvature_1pw : float
        c₀, c₁ and c₂, W, 1, 1/W.
    sd : ndarray, shape (5,)
        Of these five, in the order of `TERMS`.
    covariance : ndarray, shape (5, 5)
    creep_mps : float
    gaining_share : float
        What gaining speed costs beyond the accelerated mass, as a share of it.
    top_w : float
        Power up to which the model was fitted; above it goes on straight.
    warm_up_j, warm_up_sd_j : float or None
        What a start from cold adds; None where no test began cold.
    rms_w : float
        Of the residuals over ten seconds each.
    block_sd_j : float
        What two minutes of driving differ from the model.
    quadratic : bool
        Whether the data speak for c₂.
    distance_m : float
        Driven in the tests it was fitted to.
    tests : tuple of str
    """

    idle_w: float
    overrun_w: float
    constant_w: float
    slope: float
    curvature_1pw: float
    sd: FloatArray
    covariance: FloatArray
    creep_mps: float
    gaining_share: float
    top_w: float
    warm_up_j: float | None
    warm_up_sd_j: float | None
    rms_w: float
    block_sd_j: float
    quadratic: bool
    distance_m: float
    tests: tuple[str, ...]

    @property
    def coefficients(self) -> FloatArray:
        """Those of `TERMS`, shape (5,)."""
        return np.array([self.idle_w, self.overrun_w, self.constant_w, self.slope, self.curvature_1pw])


@dataclass(frozen=True, slots=True)
class FuelPrediction:
    """What a drive should burn.

    Attributes
    ----------
    energy_j, energy_sd_j : float
        In all.
    warm_up_j : float
        The share of it that warmed the engine up.
    power_w : ndarray, shape (n,)
    beyond_top : float
        Share of the energy at the wheels that was asked for at more power than the model was fitted to.
    """

    energy_j: float
    energy_sd_j: float
    warm_up_j: float
    power_w: FloatArray
    beyond_top: float


@dataclass(frozen=True, slots=True)
class Demand:
    """What a drive asks of the engine once a second; arrays of shape (n,).

    ``power_w`` is the power at the wheels, counted with the creep speed where the car is slower than that.
    """

    power_w: FloatArray
    standing: BoolArray
    creeping: BoolArray
    runs: BoolArray


def demand(cycle: DrivingCycle, load: RoadLoad, creep_mps: float, gaining_share: float, *, by_fuel: bool) -> Demand:
    """Work out what a drive asks of the engine; see `WheelFuelModel` and `engine_runs`."""
    speed = cycle.speed_mps
    force = propulsion_n(speed, load, gaining_share)
    power = force * np.where((force > 0.0) & (speed < creep_mps), creep_mps, speed)
    return Demand(power, speed < STANDING_MPS, speed < creep_mps, engine_runs(cycle, by_fuel=by_fuel))


def hot_terms(asked: Demand, coefficients: FloatArray, top_w: float) -> FloatArray:
    """Return what each of `TERMS` is multiplied by, shape (n, 5); which of them counts depends on the coefficients."""
    willans = _willans(asked.power_w, top_w)
    idles = asked.standing | asked.creeping
    driving = ~asked.standing & (willans @ coefficients[2:] > np.where(idles, coefficients[0], coefficients[1]))
    terms = np.zeros((len(asked.power_w), 5))
    terms[asked.runs & ~driving & idles, 0] = 1.0
    terms[asked.runs & ~driving & ~idles, 1] = 1.0
    burning = asked.runs & driving
    terms[burning, 2:] = willans[burning]
    return terms


def warm_up(asked: Demand) -> FloatArray:
    """Return for each start of the engine the power per joule of its warm-up, shape (n, starts)."""
    begins = [begin for begin, _ in stretches(asked.runs)]
    columns = np.zeros((len(asked.runs), len(begins)))
    for number, begin in enumerate(begins):
        end = begins[number + 1] if number + 1 < len(begins) else len(asked.runs)
        running = asked.runs[begin:end]
        columns[begin:end, number] = np.exp(-(np.cumsum(running) - 1) / WARM_UP_S) / WARM_UP_S * running
    return columns


def predict(model: WheelFuelModel, cycle: DrivingCycle, load: RoadLoad, *, cold: bool = False) -> FuelPrediction:
    """Predict the fuel of a drive from its speed alone; what was measured of its fuel is not looked at.

    Parameters
    ----------
    model : WheelFuelModel
    cycle : DrivingCycle
    load : RoadLoad
    cold : bool
        Whether the engine is at the temperature of its surroundings at first. Where no test of the model began cold,
        `COLD_SHARE` is taken.
    """
    asked = demand(cycle, load, model.creep_mps, model.gaining_share, by_fuel=False)
    terms = hot_terms(asked, model.coefficients, model.top_w)
    hot_w = terms @ model.coefficients
    coldness = _coldness(asked, cold)
    once, once_sd = model.warm_up_j, model.warm_up_sd_j
    if once is None or once_sd is None:
        running = hot_w[asked.runs][:COLD_SHARE_S]
        beginning = float(running.mean()) * COLD_SHARE_S if running.size else 0.0
        once, once_sd = COLD_SHARE * beginning, COLD_SHARE_SD * beginning
    power = hot_w + once * (warm_up(asked) @ coldness)
    sums = terms.sum(axis=0)
    blocks = asked.runs.sum() / 120.0
    variance = sums @ model.covariance @ sums + (once_sd * coldness.sum()) ** 2 + blocks * model.block_sd_j**2
    propelled = np.maximum(asked.power_w, 0.0)
    return FuelPrediction(
        energy_j=float(power.sum()),
        energy_sd_j=float(np.sqrt(variance)),
        warm_up_j=float(power.sum() - hot_w.sum()),
        power_w=power,
        beyond_top=float(propelled[propelled > model.top_w].sum() / max(float(propelled.sum()), 1.0)),
    )


def _coldness(asked: Demand, cold: bool) -> FloatArray:
    """How cold each start of the engine is, 0 to 1, shape (starts,)."""
    runs = stretches(asked.runs)
    pauses = [begin - end for (_, end), (begin, _) in pairwise(runs)]
    return np.array([float(cold)] * bool(runs) + [1.0 - float(np.exp(-pause / COOLING_S)) for pause in pauses])


def _willans(power_w: FloatArray, top_w: float) -> FloatArray:
    """Return 1, P and P² (straight beyond the top, nothing below zero), shape (n, 3)."""
    within = np.clip(power_w, 0.0, top_w)
    square = within * (within + 2.0 * np.maximum(power_w - top_w, 0.0))
    return np.stack([np.ones_like(power_w), power_w, square], axis=1)
