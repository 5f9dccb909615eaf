"""A small made-up drive with known truth, for tests that need an observation but no observer."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import Recording, Series
from app.science.observer.result import Innovations, Observation, Refusal, SensorConsistency
from app.science.observer.states import STATE_COLUMNS

PHI = (9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04)
RATIOS = (13.25, 9.604, 7.37, 5.796, 4.208, 3.23)
WHEEL_RADIUS_M = 0.2954
START_UTC_S = 1_256_629_260.0

EPISODES = (Refusal(10.0, 12.0, 5, True), Refusal(40.0, 40.0, 1, False), Refusal(90.5, 93.5, 6, True))


def table_4_1(rpm: FloatArray, nm: FloatArray) -> FloatArray:
    """Efficiency of the engine of Sebesta 2010, Table 4.1."""
    w = np.asarray(rpm) * pi / 30.0
    a = PHI
    phi = a[0] + a[1] * w + a[2] * nm + a[3] * w * nm + a[4] * w**2 + a[5] * np.asarray(nm) ** 2
    return np.asarray(1.0 / phi)


def points_at(rpm: FloatArray, nm: FloatArray) -> OperatingPoints:
    """Exact operating points of the Table 4.1 engine, one a second."""
    efficiency = table_4_1(rpm, nm)
    power = rpm * nm * pi / 30.0
    return OperatingPoints(
        t_s=np.arange(len(rpm), dtype=np.float64),
        engine_speed_rpm=rpm,
        torque_nm=nm,
        power_w=power,
        fuel_power_w=power / efficiency,
        efficiency=efficiency,
        efficiency_sd=np.full(len(rpm), 0.01),
        torque_source="observer",
    )


def random_points(count: int, seed: int = 1) -> OperatingPoints:
    """Exact points spread over 1200–5000 rpm and 20–100 Nm."""
    rng = np.random.default_rng(seed)
    return points_at(rng.uniform(1200.0, 5000.0, count), rng.uniform(20.0, 100.0, count))


def drive(seconds: float = 600.0, step_s: float = 0.1, seed: int = 3) -> Observation:
    """A drive on a loop through hills: speeds up, cruises, coasts without fuel, brakes and stands, over and over.

    Thrust, fuel and engine speed belong together exactly by Table 4.1.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, step_s)
    n = len(t)
    phase = t % 120.0
    speed = np.interp(phase, [0, 8, 30, 50, 80, 95, 110, 120], [0, 0, 17, 22, 28, 26, 0, 0])
    gear = np.select([speed < 0.5, speed < 7, speed < 13, speed < 18, speed < 25], [0, 1, 2, 3, 4], 5).astype(
        np.float64
    )
    ratio = np.where(gear > 0, np.array((0.0, *RATIOS))[gear.astype(int)], 0.0) / WHEEL_RADIUS_M
    turning = np.where(gear > 0, np.maximum(speed * ratio, 85.0), 89.0)
    wave = 35.0 + 25.0 * np.sin(t / 7.0) + np.cumsum(rng.normal(0.0, 0.3, n)) % 20.0
    torque = np.clip(wave, 12.0, 95.0)
    driven = (phase > 8) & (phase < 90) & (gear > 0)
    power = np.where(driven, torque * turning, 0.0)
    thrust = np.divide(power, speed, out=np.zeros(n), where=speed > 0.5)
    power = thrust * speed
    efficiency = np.where(power > 2000.0, table_4_1(turning * 30 / pi, torque), np.nan)
    fuel = np.where(power > 2000.0, power / np.where(np.isfinite(efficiency), efficiency, 1.0), 0.0)
    distance = np.cumsum(speed) * step_s
    around = distance / 3000.0
    heading = around + pi / 2
    states = {
        "distance_m": distance,
        "speed_mps": speed,
        "thrust_n": thrust,
        "heading_rad": heading,
        "pitch_rad": 0.03 * np.cos(distance / 400.0),
        "north_m": 3000.0 * np.sin(around),
        "east_m": 3000.0 * (1 - np.cos(around)),
        "down_m": -12.0 * np.sin(distance / 400.0),
        "curvature_h_radpm": np.full(n, 1 / 3000.0),
        "curvature_v_radpm": -0.03 / 400.0 * np.sin(distance / 400.0),
        "fuel_energy_j": np.cumsum(fuel) * step_s,
        "fuel_power_w": fuel,
        "engine_angle_rad": np.cumsum(turning) * step_s,
        "engine_speed_radps": turning,
        "bias_i_mps2": np.full(n, 0.02),
        "bias_j_mps2": np.full(n, -0.01),
        "bias_k_mps2": np.full(n, 0.03),
    }
    columns: dict[str, FloatArray] = {"t_s": t}
    for name in STATE_COLUMNS:
        columns[name] = states[name]
        columns[f"{name}_sd"] = 0.02 * (1.0 + np.abs(states[name]))
    columns |= {
        "lat_deg": 48.85 + states["north_m"] / 111_200.0,
        "lon_deg": 2.35 + states["east_m"] / 73_200.0,
        "alt_m": 60.0 - states["down_m"],
        "torque_nm": power / turning,
        "power_w": power,
        "efficiency": efficiency,
        "gear": gear,
    }
    names = ("vss", "acc_i", "gps_north")
    count = n // 2
    sd = np.full(count, 0.3)
    accepted = np.ones(count, np.int64)
    accepted[::97] = 0
    innovations = Innovations(
        t_s=t[:count] * 2.0,
        sensor=np.arange(count, dtype=np.int64) % 3,
        innovation=rng.normal(0.0, 0.3, count) * np.where(accepted == 1, 1.0, 20.0),
        sd=sd,
        accepted=accepted,
        sensors=names,
    )
    sensors = tuple(
        SensorConsistency(
            name,
            count // 3,
            k,
            nis,
            inside,
            0.71 * inside,
            0.94,
            1.07,
            count / 9,
            lag1,
            1.0 + 9.0 * lag1,
            0.02,
            0.01,
            recovered=k // 4,
            episodes=EPISODES[: k // 4],
            episode_count=k // 4,
            longest_refusal_s=float(k // 4),
        )
        for name, k, nis, inside, lag1 in zip(
            names, (3, 0, 12), (1.02, 0.9, 2.4), (0.951, 0.962, 0.81), (0.01, -0.02, 0.6), strict=True
        )
    )
    energy = float(columns["fuel_energy_j"][-1])
    return Observation(
        columns=columns,
        innovations=innovations,
        sensors=sensors,
        verdict="doubtful",
        reasons=("gps_north: innovations are 1.5 times larger than expected",),
        warnings=("a gap of 3.2 s was bridged",),
        events=54_321,
        duration_s=seconds,
        distance_m=float(distance[-1]),
        fuel_energy_j=energy,
        fuel_l=energy / 32.0e6,
        filter="ekf",
        tuning="default",
        smoothed=True,
    )


def with_columns(observation: Observation, **columns: FloatArray) -> Observation:
    """Return the observation with some columns replaced."""
    return replace(observation, columns={**observation.columns, **columns})


def sensors_of(observation: Observation) -> Recording:
    """Measurements that go with a drive: odometer ticks, accelerometer, injector and receiver, noiseless."""
    c = observation.columns
    t = c["t_s"]
    ticks = np.flatnonzero(np.diff(c["distance_m"] // 2.7) > 0)
    fix = slice(0, None, 10)
    utc = START_UTC_S + t[fix]
    signals = {
        "vss_tick": Series(t[ticks], np.full(len(ticks), 10.0)),
        "ax_mps2": Series(t, 0.5 * np.sin(t)),
        "ay_mps2": Series(t, 0.1 * np.cos(t)),
        "az_mps2": Series(t, np.full(len(t), -9.805)),
        "injector_pulse_s": Series(t[5::3], np.full(len(t[5::3]), 0.003)),
        "lat_deg": Series(t[fix], c["lat_deg"][fix]),
        "lon_deg": Series(t[fix], c["lon_deg"][fix]),
        "alt_m": Series(t[fix], c["alt_m"][fix]),
        "hdop": Series(t[fix], np.full(len(utc), 1.1)),
        "satellites": Series(t[fix], np.full(len(utc), 8.0)),
        "utc_s": Series(t[fix], utc),
    }
    return Recording(
        signals,
        started_at_utc_s=START_UTC_S,
        texts={"nmea": "$GPGGA,074100.0,4851.0000,N,00221.0000,E,1,08,1.1,60.0,M,,M,,*5D\r\n"},
        warnings=("3 packets had a bad checksum",),
    )
