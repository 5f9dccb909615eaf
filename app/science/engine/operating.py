"""From the states of a trip to the operating points of its engine."""

from __future__ import annotations

from math import pi

import numpy as np

from app.science.engine.ecu import ecu_points
from app.science.engine.points import OperatingPoints
from app.science.engine.rules import PointRules, certain, meaningful, settled
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

RPM_PER_RADPS = 30.0 / pi
DEFAULT_RULES = PointRules()


def operating_points(
    observation: Observation, recording: Recording, vehicle: Vehicle, rules: PointRules = DEFAULT_RULES
) -> OperatingPoints:
    """Take the moments at which the engine propels the car (Sebesta 2010, 3.3).

    Where the engine control unit reports its torque, the points are taken at its samples (`ecu_points`); otherwise
    at the observer's nodes.

    Parameters
    ----------
    observation : Observation
    recording : Recording
        The measurements the observation was made from.
    vehicle : Vehicle
    rules : PointRules, optional

    Returns
    -------
    OperatingPoints
        Possibly empty, in the order of time.
    """
    if "engine_torque_nm" in recording:
        return ecu_points(observation, recording, vehicle, rules)
    return _observer_points(observation, vehicle, rules)


def _observer_points(observation: Observation, vehicle: Vehicle, rules: PointRules) -> OperatingPoints:
    """Compute η = F_T v / P_in at the nodes.

    The relative variances of thrust, speed and fuel power add up: fuel and motion never couple in the filter, and the
    error of speed is far below that of thrust, so that their covariance does not matter.
    """
    c = observation.columns
    t, thrust, speed, fuel = c["t_s"], c["thrust_n"], c["speed_mps"], c["fuel_power_w"]
    turning = c["engine_speed_radps"]
    power = thrust * speed
    keep = meaningful(power, fuel, rules) & (turning > 0.0) & (speed > 0.0)
    if vehicle.gear_ratios and np.any(c["gear"] >= 1):
        keep &= settled(t, t, c["gear"], rules)
    relative = np.sqrt(
        (c["thrust_n_sd"][keep] / thrust[keep]) ** 2
        + (c["speed_mps_sd"][keep] / speed[keep]) ** 2
        + (c["fuel_power_w_sd"][keep] / fuel[keep]) ** 2
    )
    efficiency = power[keep] / fuel[keep]
    sure = certain(efficiency * relative, rules)
    chosen = np.flatnonzero(keep)[sure]
    return OperatingPoints(
        t_s=t[chosen],
        engine_speed_rpm=turning[chosen] * RPM_PER_RADPS,
        torque_nm=power[chosen] / turning[chosen],
        power_w=power[chosen],
        fuel_power_w=fuel[chosen],
        efficiency=efficiency[sure],
        efficiency_sd=(efficiency * relative)[sure],
        torque_source="observer",
    )
