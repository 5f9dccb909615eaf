"""What the sensors of one trip tell: by the rank test, without each sensor, and minute by minute."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.observer.observability.car_system import MEASUREMENTS, TYPICAL, car_in_gear
from app.science.observer.observability.gramian import WINDOW_S, information_along
from app.science.observer.observability.losses import USUAL_GEAR, Loss, SensorTest, losses, sensors_of
from app.science.observer.observability.words import words_of
from app.science.observer.result import Observation
from app.science.observer.tuning import Tuning
from app.science.vehicle.model import Vehicle

ENOUGH = 0.2
"""A window tells a state whose standard deviation it brings below this share of what one knew without sensors."""


@dataclass(frozen=True, slots=True)
class TripObservability:
    """What the sensors of a trip tell of the 17 states.

    Attributes
    ----------
    measurements, sensors : tuple of str
        What was measured, by the names of `Innovations`, and the sensors behind it.
    losses : tuple of Loss
        What the rank test says of the whole set, and of it without each sensor.
    words : tuple of str
        The same as sentences, one for each of ``losses``.
    window_s : float
    begin_s : array, shape (windows,)
    prior_sd : array, shape (17,)
        What one would say of each state without any sensor.
    sd : array, shape (windows, 17)
        What is left of it by the measurements of one window alone.
    """

    measurements: tuple[str, ...]
    sensors: tuple[str, ...]
    losses: tuple[Loss, ...]
    words: tuple[str, ...]
    window_s: float
    begin_s: FloatArray
    prior_sd: FloatArray
    sd: FloatArray

    @property
    def told_share(self) -> FloatArray:
        """Share of the windows that tell each state, shape (17,)."""
        return np.asarray(np.mean(self.sd < ENOUGH * self.prior_sd, axis=0))


def observability_of(observation: Observation, vehicle: Vehicle, tuning: Tuning) -> TripObservability:
    """Return what the sensors of a trip tell, whatever the filter made of it."""
    measurements = measured(observation)
    found = losses(SensorTest(car_in_gear(vehicle, USUAL_GEAR)), measurements)
    along = information_along(observation, vehicle, tuning)
    return TripObservability(
        measurements=measurements,
        sensors=tuple(sensors_of(measurements)),
        losses=found,
        words=words_of(found),
        window_s=WINDOW_S,
        begin_s=along.begin_s,
        prior_sd=TYPICAL,
        sd=along.sd(TYPICAL),
    )


def measured(observation: Observation) -> tuple[str, ...]:
    """Return the names of the measurements that were taken in at least once."""
    seen = observation.innovations
    taken = np.bincount(seen.sensor[seen.accepted == 1].astype(np.int64), minlength=len(seen.sensors))
    return tuple(name for name, count in zip(seen.sensors, taken, strict=True) if count > 0 and name in MEASUREMENTS)
