"""What the logger's own sensors see of a drive: accelerometer, wheel ticks, injector pulses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from app.science.arrays import FloatArray, IntArray
from app.science.errors import ScienceError
from app.science.vehicle.model import STANDARD_GRAVITY_MPS2, Vehicle
from app.science.virtualcar.driver import STEP_S, Drive
from app.science.virtualcar.road import Road
from app.science.virtualcar.specification import SensorSettings

ACCELEROMETER_STEPS = 5
TICK_MIN_SPEED_MPS = 1.1
INJECTOR_COUNT_S = 250e-9


@dataclass(frozen=True, slots=True)
class AccelerometerSamples:
    """Raw samples: milliseconds of trip time, shape (n,), and milli-g counts of the sensor's axes, shape (n, 3)."""

    ms: IntArray
    counts: IntArray


@dataclass(frozen=True, slots=True)
class Ticks:
    """Wheel ticks: trip time in units of 125 µs, shape (n,)."""

    eighths_ms: IntArray


@dataclass(frozen=True, slots=True)
class Pulses:
    """Injector pulses: milliseconds of trip time and length in units of 250 ns, both of shape (n,)."""

    ms: IntArray
    counts: IntArray


def body_acceleration(drive: Drive, road: Road, vehicle: Vehicle, every: int) -> FloatArray:
    """Specific force in forward, right, down axes without error, m/s², shape (n, 3), every so many steps.

    a_i = (F − drag)/M_a + g sin θ (1 − M/M_a): the accelerometer feels all of gravity, unlike in Sebesta 2010, (1.18),
    which leaves the last term out.
    """
    rows = slice(None, None, every)
    v, s, gear = drive.speed_mps[rows], drive.distance_m[rows], drive.gear[rows].astype(np.int64)
    pitch = np.interp(s, road.distance_m, road.pitch_rad)
    curvature_h = np.interp(s, road.distance_m, road.curvature_h_radpm)
    curvature_v = np.interp(s, road.distance_m, road.curvature_v_radpm)
    masses = np.array([vehicle.accelerated_mass_kg(g) for g in range(len(vehicle.gear_ratios) + 1)])[gear]
    g = vehicle.gravity_mps2
    roll = vehicle.mass_kg * vehicle.crr * (g * np.cos(pitch) + curvature_v * v**2) * (v > 0)
    drag = vehicle.drag_area_kgpm * v**2 + roll
    along = (drive.thrust_n[rows] - drag) / masses + g * np.sin(pitch) * (1.0 - vehicle.mass_kg / masses)
    return np.column_stack([along, curvature_h * v**2, -(g * np.cos(pitch) + curvature_v * v**2)])


def accelerometer(
    drive: Drive,
    road: Road,
    vehicle: Vehicle,
    bias_mps2: FloatArray,
    settings: SensorSettings,
    rng: np.random.Generator,
) -> AccelerometerSamples:
    """Sample the accelerometer at 40 Hz: bias, coloured noise growing with speed, mounting, 1 mg counts.

    Parameters
    ----------
    bias_mps2 : array, shape (3,)
        Constant error in body axes.
    """
    body = body_acceleration(drive, road, vehicle, ACCELEROMETER_STEPS)
    keep = np.exp(-ACCELEROMETER_STEPS * STEP_S / settings.accelerometer_correlation_s)
    white = rng.standard_normal(body.shape)
    white[1:] *= np.sqrt(1.0 - keep**2)
    coloured = lfilter([1.0], [1.0, -keep], white, axis=0)
    v = drive.speed_mps[::ACCELEROMETER_STEPS, None]
    sd = np.array(settings.accelerometer_sd_mps2) + np.array(settings.accelerometer_sd_per_mps) * v
    measured = body + bias_mps2 + sd * coloured
    raw = np.linalg.solve(vehicle.mounting.matrix, measured.T).T
    counts = np.clip(np.rint(raw / (STANDARD_GRAVITY_MPS2 * 1e-3)), -32768, 32767).astype(np.int64)
    ms = np.arange(len(counts)) * round(ACCELEROMETER_STEPS * STEP_S * 1000)
    return AccelerometerSamples(ms, counts)


def wheel_ticks(drive: Drive, metres_per_tick: float) -> Ticks:
    """One tick per ``metres_per_tick``, stamped by a clock of 125 µs, none below walking pace."""
    count = int(drive.distance_m[-1] / metres_per_tick)
    moving = np.concatenate([[True], np.diff(drive.distance_m) > 0])
    t = np.interp(np.arange(1, count + 1) * metres_per_tick, drive.distance_m[moving], drive.t_s[moving])
    fast = np.interp(t, drive.t_s, drive.speed_mps) > TICK_MIN_SPEED_MPS
    return Ticks(np.floor(t[fast] * 8000.0).astype(np.int64))


def injector_pulses(drive: Drive, vehicle: Vehicle) -> Pulses:
    """One pulse per engine cycle that got fuel, carrying the energy burned since the pulse before.

    So the pulses' energies, summed up to a pulse, are the fuel energy at its time. Cycles without fuel (overrun, engine
    off) have no pulse; what little a cycle got beside a fuel cut goes with the next pulse.

    Raises
    ------
    ScienceError
        When the injectors are too small for the engine: a pulse would not fit the logger's 16 bits.
    """
    per_pulse = vehicle.engine_angle_per_pulse_rad
    turning = np.concatenate([[True], np.diff(drive.engine_angle_rad) > 0])
    cycles = np.arange(1, int(drive.engine_angle_rad[-1] / per_pulse) + 1) * per_pulse
    t = np.interp(cycles, drive.engine_angle_rad[turning], drive.t_s[turning])
    energy = np.interp(t, drive.t_s, drive.fuel_energy_j)
    least = drive.fuel_power_w[drive.fuel_power_w > 0].min(initial=np.inf)
    fuelled = np.diff(energy, prepend=0.0) > 0.5 * least * np.diff(t, prepend=0.0)
    t, energy = t[fuelled], np.diff(energy[fuelled], prepend=0.0)
    share = 1.0 / vehicle.injection.groups if vehicle.injection.pattern == "grouped" else 1.0
    joules_per_second = vehicle.injection.litres_per_second * share * vehicle.fuel_energy_j_per_l
    counts = np.rint((energy / joules_per_second - vehicle.injection.lag_s) / INJECTOR_COUNT_S).astype(np.int64)
    if len(counts) and counts.max() > 0xFFFF:
        raise ScienceError(
            f"The injectors are too small for this engine: a pulse of {counts.max() * INJECTOR_COUNT_S * 1e3:.1f} ms "
            "is longer than the logger's 16.4 ms. Give the car a larger fuelPerSecond."
        )
    return Pulses(np.floor(t * 1000.0).astype(np.int64), counts)
