"""Half a year of trips, charged unseen between them, with a fading capacity: is the history of health honest?"""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.ageing import HealthPoint, ageing
from app.science.battery.carrying import between
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit
from app.science.battery.estimate import estimate
from app.science.battery.record import BatteryRecord
from app.science.battery.run import Carry
from app.science.battery.simulate import simulate
from app.science.battery.virtual.current import BlendedCar, cell_current
from app.science.battery.virtual.ftp72 import ftp_72

CURVE = OpenCircuit(
    points=tuple(
        zip(
            (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0),
            (3.0, 3.3, 3.45, 3.55, 3.6, 3.64, 3.69, 3.77, 3.87, 3.96, 4.06, 4.18),
            strict=True,
        )
    )
)
RATED_AH, FADE_PER_YEAR = 2.0, 0.10
BIAS_A = 0.02
TRIP_S = 1800


def half_a_year(seed: int, trips: int) -> tuple[FloatArray, list[HealthPoint]]:
    """Return true capacities, Ah, and what the estimates say at each trip's end."""
    rng = np.random.default_rng(seed)
    drive_a = cell_current(BlendedCar(), *ftp_72())
    days = np.sort(rng.uniform(0.0, 182.0, trips)) + 0.05 * np.arange(trips)
    config = BatteryConfig(Cell(CURVE, Circuit(2.2, 0.010, 3000.0, 0.010), 0.5), rated_capacity_ah=RATED_AH)
    bias_a = BIAS_A * rng.standard_normal()
    carry: Carry | None = None
    truth, points = [], []
    for k, day in enumerate(days):
        if carry is not None:
            pause_days = day - days[k - 1]
            kept = np.exp(-pause_days / 7.0)
            bias_a = kept * bias_a + BIAS_A * np.sqrt(1.0 - kept**2) * rng.standard_normal()
            carry = between(carry, 86400.0 * pause_days - TRIP_S, config)
        capacity_ah = RATED_AH * (1.0 - FADE_PER_YEAR * day / 365.25)
        cell = Cell(CURVE, Circuit(capacity_ah, 0.008, 2700.0, 0.011), rng.uniform(0.5, 0.95))
        t_s = np.arange(TRIP_S + 1.0)
        current_a = np.resize(np.roll(drive_a, rng.integers(len(drive_a))), len(t_s))
        voltage_v = simulate(cell, t_s, current_a).voltage_v + 0.002 * rng.standard_normal(len(t_s))
        measured_a = current_a + bias_a + 0.01 * rng.standard_normal(len(t_s))
        found = estimate(BatteryRecord(t_s, measured_a, voltage_v), config, carry)
        carry, answer = found.carry, found.document()
        truth.append(capacity_ah)
        points.append(HealthPoint(float(day), answer["capacity_ah"], answer["capacity_ah_sd"]))
    return np.array(truth), points


def test_health_is_tracked_with_honest_bands_through_trips_that_are_charged_unseen() -> None:
    inside, errors, along = [], [], []
    for seed in (1, 2):
        truth, points = half_a_year(seed, 24)
        said = np.array([[one.capacity_ah, one.capacity_sd] for one in points])
        inside.append(np.abs(said[:, 0] - truth) < 2.0 * said[:, 1])
        errors.append(said[8:, 0] / truth[8:] - 1.0)
        trend = ageing(points, rated_ah=RATED_AH).capacity.trend
        assert trend is not None
        at = np.array([one.at for one in points])
        along.append(np.abs(trend.at(at) - truth) < 2.0 * trend.sd(at))
        slope, sd = 365.25 / RATED_AH * np.array([trend.slope(at[-1:])[0], trend.slope_sd(at[-1:])[0]])
        assert abs(slope + FADE_PER_YEAR) < 3.0 * sd
        assert sd < 0.05
    assert np.mean(inside) >= 0.9
    assert np.mean(along) >= 0.8
    assert np.sqrt(np.mean(np.square(errors))) < 0.012
