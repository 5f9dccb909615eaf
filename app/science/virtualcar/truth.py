"""What really happened: the table and the summary that estimates are held against."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.science.arrays import FloatArray
from app.science.virtualcar.driver import STEP_S, Drive
from app.science.virtualcar.receiver import to_geographic
from app.science.virtualcar.road import Road

PROPELLING_W = 2000.0


def truth_columns(
    drive: Drive, road: Road, bias_mps2: FloatArray, start_lat_deg: float, start_lon_deg: float, step_s: float
) -> Mapping[str, FloatArray]:
    """Columns of ``truth.parquet``, every array of shape (n,).

    ``north_m`` and ``east_m`` count from the start, ``down_m`` is minus the altitude. ``thrust_n`` contains the brakes,
    as the paper's model does; ``torque_nm`` is thrust · speed / engine speed, so it is the engine's own torque wherever
    the engine propels the car in gear. ``gear`` is 0 while the clutch is open or slips. ``efficiency`` is NaN where
    thrust · speed is at most 2 kW.
    """
    rows = slice(None, None, round(step_s / STEP_S))
    s = drive.distance_m[rows]

    def on_road(values: FloatArray) -> FloatArray:
        return np.asarray(np.interp(s, road.distance_m, values))

    north, east, alt = on_road(road.north_m), on_road(road.east_m), on_road(road.alt_m)
    place = to_geographic(north, east, start_lat_deg, start_lon_deg)
    thrust, speed = drive.thrust_n[rows], drive.speed_mps[rows]
    omega, fuel_power = drive.engine_speed_radps[rows], drive.fuel_power_w[rows]
    power = thrust * speed
    propelling = (power > PROPELLING_W) & (fuel_power > 0)
    ones = np.ones_like(s)
    return {
        "t_s": drive.t_s[rows],
        "distance_m": s,
        "speed_mps": speed,
        "thrust_n": thrust,
        "heading_rad": np.mod(on_road(road.heading_rad), 2 * np.pi),
        "pitch_rad": on_road(road.pitch_rad),
        "north_m": north,
        "east_m": east,
        "down_m": -alt,
        "curvature_h_radpm": on_road(road.curvature_h_radpm),
        "curvature_v_radpm": on_road(road.curvature_v_radpm),
        "fuel_energy_j": drive.fuel_energy_j[rows],
        "fuel_power_w": fuel_power,
        "engine_angle_rad": drive.engine_angle_rad[rows],
        "engine_speed_radps": omega,
        "bias_i_mps2": bias_mps2[0] * ones,
        "bias_j_mps2": bias_mps2[1] * ones,
        "bias_k_mps2": bias_mps2[2] * ones,
        "lat_deg": place[:, 0],
        "lon_deg": place[:, 1],
        "alt_m": alt,
        "torque_nm": np.divide(power, omega, out=np.zeros_like(power), where=omega > 1.0),
        "power_w": power,
        "efficiency": np.divide(power, fuel_power, out=np.full_like(power, np.nan), where=propelling),
        "gear": drive.gear[rows],
    }
