"""What a car's earlier trips say about its accelerometer's biases before the next one begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.observer.result import Observation

AXES = ("i", "j", "k")
START_SD_MPS2 = 0.3
"""How little is known of a bias before anything is measured."""
LEARNT_SD_MPS2 = 0.2
"""A bias less certain than this at the end of a trip was hardly measured on it; it says nothing of the next."""
TRIP_TO_TRIP_SD_MPS2 = 0.05
"""How much a bias is expected to change between trips: 5 mg, as of 25 kelvin or a pitch of 0.3° more or less."""
EXPECTED_TRIPS = 4.0
"""That expectation counts like the scatter seen over so many trips."""
LOAD_SD_MPS2_PER_KG = (1e-3, 2e-4, 2e-4)
"""100 kg on one axle lower it by some 25 mm, over a wheelbase of 2.5 m that is 0.01 rad of pitch."""

Three = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class FinalBias:
    """What a trip knew of the biases at its end.

    Attributes
    ----------
    mean, sd : (forward, right, down)
        m/s².
    load_kg : float
        Driver and things it was observed with.
    """

    mean: Three
    sd: Three
    load_kg: float


@dataclass(frozen=True, slots=True)
class BiasPrior:
    """What a trip may expect of the biases at its start.

    Attributes
    ----------
    mean, sd : (forward, right, down)
        m/s².
    """

    mean: Three
    sd: Three


def final_bias(observation: Observation, load_kg: float) -> FinalBias | None:
    """Return what a trip's end knows of the biases; None where they were not estimated."""
    mean, sd = ([float(observation.columns[f"bias_{axis}_mps2{kind}"][-1]) for axis in AXES] for kind in ("", "_sd"))
    if not np.isfinite([mean, sd]).all() or min(sd) <= 0.0:
        return None
    return FinalBias(_three(mean), _three(sd), load_kg)


def bias_prior(earlier: Sequence[FinalBias], load_kg: float) -> BiasPrior | None:
    """Return what earlier trips of the same mounting say of the biases of the next.

    Each trip's bias is taken for the car's own plus a change drawn anew for each trip. The variance of that change is
    `TRIP_TO_TRIP_SD_MPS2` squared, drawn towards the scatter seen as trips add up; a trip with another load counts
    less. The prior is the weighted mean, with the variance of the mean and of one more change.

    Parameters
    ----------
    earlier : sequence of FinalBias
    load_kg : float
        Of the trip to come.

    Returns
    -------
    BiasPrior or None
        None when no trip measured any of the biases.
    """
    if not earlier:
        return None
    mean, sd = (np.array([getattr(trip, name) for trip in earlier]) for name in ("mean", "sd"))
    learnt = sd < LEARNT_SD_MPS2
    if not learnt.any():
        return None
    loaded = np.abs(np.array([trip.load_kg for trip in earlier]) - load_kg)
    own = sd**2 + np.outer(loaded, LOAD_SD_MPS2_PER_KG) ** 2
    change = np.full(3, TRIP_TO_TRIP_SD_MPS2**2)
    middle, _ = _weighted(mean, own + change, learnt)
    scatter = np.sum(np.where(learnt, (mean - middle) ** 2, 0.0), axis=0)
    seen = np.maximum(np.count_nonzero(learnt, axis=0) - 1.0, 0.0)
    change = (EXPECTED_TRIPS * change + scatter) / (EXPECTED_TRIPS + seen)
    middle, of_middle = _weighted(mean, own + change, learnt)
    known = learnt.any(axis=0)
    spread = np.where(known, np.minimum(np.sqrt(of_middle + change), START_SD_MPS2), START_SD_MPS2)
    return BiasPrior(_three(np.where(known, middle, 0.0)), _three(spread))


def _weighted(value: FloatArray, variance: FloatArray, counted: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return the mean weighted by inverse variance and its own variance, per axis; infinite where nothing counts."""
    weight = np.where(counted, 1.0 / variance, 0.0)
    total = np.maximum(weight.sum(axis=0), 1e-12)
    return np.sum(weight * value, axis=0) / total, 1.0 / total


def _three(values: Sequence[float] | FloatArray) -> Three:
    i, j, k = (float(value) for value in values)
    return i, j, k
