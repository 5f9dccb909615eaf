"""Virtual cars whose sensor lies anywhere, and what they recorded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from app.science.calibration.mounting import mounting_of
from app.science.calibration.turning import turn_matrix
from app.science.logger.decode import ImageDecoder
from app.science.logger.recording import Recording, series
from app.science.vehicle.model import Mounting, Vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import DEFAULT_CAR, RouteName, SensorSettings, Simulation


@dataclass(frozen=True, slots=True)
class Virtual:
    """A recording, the car that made it, and the litres it burned."""

    recording: Recording
    vehicle: Vehicle
    fuel_l: float


def any_mounting(seed: int) -> Mounting:
    """Any orientation at all, upside down as likely as not."""
    rng = np.random.default_rng(seed)
    axis = rng.standard_normal(3)
    return mounting_of(turn_matrix(rng.uniform(0.0, np.pi) * axis / np.linalg.norm(axis)), 1.0)


@cache
def drive(
    seed: int,
    duration_s: float,
    route: RouteName = "mixed",
    mounting: Mounting | None = None,
    latency_s: float = 0.05,
) -> Virtual:
    """Drive the default car, its sensor mounted as told or, else, anyhow."""
    vehicle = replace(DEFAULT_CAR, mounting=mounting or any_mounting(seed))
    sensors = SensorSettings(gps_latency_s=latency_s)
    trip = simulate(Simulation(duration_s=duration_s, seed=seed, route=route, vehicle=vehicle, sensors=sensors))
    (recording,) = ImageDecoder().trips([trip.image])
    return Virtual(recording, trip.vehicle, float(trip.summary["fuel_l"]))


def faster_clock(recording: Recording, ppm: float) -> Recording:
    """The same drive by a logger whose clock gains on UTC."""
    rate = 1.0 + 1e-6 * ppm
    stretched = {name: series(one.t_s * rate, one.value) for name, one in recording.signals.items()}
    return Recording(stretched, recording.started_at_utc_s)


def until(recording: Recording, end_s: float) -> Recording:
    """The beginning of a drive."""
    cut = {
        name: series(one.t_s[one.t_s < end_s], one.value[one.t_s < end_s]) for name, one in recording.signals.items()
    }
    return Recording({name: one for name, one in cut.items() if len(one)}, recording.started_at_utc_s)
