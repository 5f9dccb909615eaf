"""What really happened: the table and the summary that estimates are held against."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.vehicle.model import Vehicle
from app.science.virtualcar.driver import STEP_S, Drive
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.geography import place_of
from app.science.virtualcar.receiver import Outage
from app.science.virtualcar.road import Road
from app.science.virtualcar.specification import Simulation

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
    north, east, alt = road.at(s, road.north_m), road.at(s, road.east_m), road.at(s, road.alt_m)
    place = place_of(north, east, start_lat_deg, start_lon_deg)
    thrust, speed = drive.thrust_n[rows], drive.speed_mps[rows]
    omega, fuel_power = drive.engine_speed_radps[rows], drive.fuel_power_w[rows]
    power = thrust * speed
    propelling = (power > PROPELLING_W) & (fuel_power > 0)
    return {
        "t_s": drive.t_s[rows],
        "distance_m": s,
        "speed_mps": speed,
        "thrust_n": thrust,
        "heading_rad": np.mod(road.at(s, road.heading_rad), 2 * np.pi),
        "pitch_rad": road.at(s, road.pitch_rad),
        "north_m": north,
        "east_m": east,
        "down_m": -alt,
        "curvature_h_radpm": road.at(s, road.curvature_h_radpm),
        "curvature_v_radpm": road.at(s, road.curvature_v_radpm),
        "fuel_energy_j": drive.fuel_energy_j[rows],
        "fuel_power_w": fuel_power,
        "engine_angle_rad": drive.engine_angle_rad[rows],
        "engine_speed_radps": omega,
        "bias_i_mps2": np.full_like(s, bias_mps2[0]),
        "bias_j_mps2": np.full_like(s, bias_mps2[1]),
        "bias_k_mps2": np.full_like(s, bias_mps2[2]),
        "lat_deg": place.lat_deg,
        "lon_deg": place.lon_deg,
        "alt_m": alt,
        "torque_nm": np.divide(power, omega, out=np.zeros_like(power), where=omega > 1.0),
        "power_w": power,
        "efficiency": np.divide(power, fuel_power, out=np.full_like(power, np.nan), where=propelling),
        "gear": drive.gear[rows].astype(np.float64),
    }


def truth_summary(
    spec: Simulation,
    vehicle: Vehicle,
    engine: EngineModel,
    road: Road,
    drive: Drive,
    bias_mps2: FloatArray,
    outages: tuple[Outage, ...],
) -> dict[str, Any]:
    """Content of ``truth.json``: plain numbers, texts, lists and mappings.

    ``stops`` are the times at standstill (trip seconds) with the distance at which they were.
    """
    distance, fuel = float(drive.distance_m[-1]), float(drive.fuel_energy_j[-1])
    standing = np.concatenate([[False], drive.speed_mps == 0.0, [False]])
    begin, end = np.flatnonzero(np.diff(standing)).reshape(-1, 2).T
    return {
        "seed": spec.seed,
        "route": spec.route,
        "duration_s": spec.duration_s,
        "started_at_utc_s": spec.started_at_utc_s,
        "start": {"lat_deg": spec.start_lat_deg, "lon_deg": spec.start_lon_deg},
        "time_zero": "t_s is the logger's milliseconds since image.clock_start_ms, over 1000",
        "distance_m": distance,
        "fuel_energy_j": fuel,
        "fuel_l": fuel / vehicle.fuel_energy_j_per_l,
        "bias_mps2": {axis: float(b) for axis, b in zip("ijk", bias_mps2, strict=True)},
        "mounting": asdict(vehicle.mounting),
        "vehicle": asdict(vehicle) | {"mass_kg": vehicle.mass_kg},
        "engine": asdict(engine),
        "sensors": asdict(spec.sensors),
        "image": asdict(spec.image),
        "gps_outages_s": [[o.begin_s, o.end_s] for o in outages],
        "stops": [
            {"begin_s": b * STEP_S, "end_s": e * STEP_S, "distance_m": float(drive.distance_m[b])}
            for b, e in zip(begin.tolist(), (end - 1).tolist(), strict=True)
        ],
    }
