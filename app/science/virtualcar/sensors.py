"""What the logger's own sensors see of a drive: accelerometer, wheel ticks, injector pulses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from app.science.arrays import FloatArray, IntArray
from app.science.errors import ScienceError
from app.science.vehicle.model import STANDARD_GRAVITY_MPS2, Vehicle
from app.science.virtualcar.driver import STEP_S, Drive, accelerated_masses
from app.science.virtualcar.injection import angle_per_pulse_rad, open_power_w
from app.science.virtualcar.road import Road
from app.science.virtualcar.specification import SensorSettings

ACCELEROMETER_EVERY = 5
TICK_MIN_SPEED_MPS = 1.1
PULSE_COUNT_S = 250e-9


@dataclass(frozen=True, slots=True)
class AccelerometerSamples:
    """Raw samples: milliseconds of trip time, shape (n,), and milli-g counts of the sensor's axes, shape (n, 3)."""

    ms: IntArray
    counts: IntArray


@dataclass(frozen=True, slots=True)
class Pulses:
    """Injector pulses: milliseconds of trip time and length in units of 250 ns, both of shape (n,)."""

    ms: IntArray
    counts: IntArray


def body_acceleration(drive: Drive, road: Road, vehicle: Vehicle, every: int = 1) -> FloatArray:
    """Specific force in forward, right, down axes without error, m/s², shape (n, 3), every so many steps.

    a_i = (F − drag)/M_a + g sin θ (1 − M/M_a): a real accelerometer feels all of gravity, unlike in Sebesta 2010,
    (1.18), which leaves the last term out. a_j = S_j v², a_k = −(g cos θ + S_k v²).
    """
    rows = slice(None, None, every)
    v, s = drive.speed_mps[rows], drive.distance_m[rows]
    pitch, bend = road.at(s, road.pitch_rad), road.at(s, road.curvature_v_radpm)
    mass, accelerated = vehicle.mass_kg, accelerated_masses(vehicle)[drive.gear[rows]]
    down = vehicle.gravity_mps2 * np.cos(pitch) + bend * v**2
    drag = vehicle.drag_area_kgpm * v**2 + mass * vehicle.crr * down * (v > 0)
    along = (drive.thrust_n[rows] - drag) / accelerated
    along += vehicle.gravity_mps2 * np.sin(pitch) * (1.0 - mass / accelerated)
    return np.column_stack([along, road.at(s, road.curvature_h_radpm) * v**2, -down])


def coloured(n: int, axes: int, step_s: float, correlation_s: float, rng: np.random.Generator) -> FloatArray:
    """First-order Gauss–Markov noise of unit variance, stationary from its first sample, shape (n, axes)."""
    keep = np.exp(-step_s / correlation_s)
    white = rng.standard_normal((n, axes))
    white[1:] *= np.sqrt(1.0 - keep**2)
    return np.asarray(lfilter([1.0], [1.0, -keep], white, axis=0))


def accelerometer(
    drive: Drive,
    road: Road,
    vehicle: Vehicle,
    bias_mps2: FloatArray,
    settings: SensorSettings,
    rng: np.random.Generator,
) -> AccelerometerSamples:
    """Sample the accelerometer at 40 Hz: bias, noise that grows with speed, mounting, counts of 1 mg.

    Parameters
    ----------
    bias_mps2 : array, shape (3,)
        Constant error in body axes.
    """
    body = body_acceleration(drive, road, vehicle, ACCELEROMETER_EVERY)
    step_s = ACCELEROMETER_EVERY * STEP_S
    speed = drive.speed_mps[::ACCELEROMETER_EVERY, None]
    sd = np.array(settings.accelerometer_sd_mps2) + np.array(settings.accelerometer_sd_per_mps) * speed
    noise = sd * coloured(len(body), 3, step_s, settings.accelerometer_correlation_s, rng)
    raw = np.linalg.solve(vehicle.mounting.matrix, (body + bias_mps2 + noise).T).T
    counts = np.clip(np.rint(raw / (STANDARD_GRAVITY_MPS2 * 1e-3)), -32768, 32767).astype(np.int64)
    return AccelerometerSamples(np.arange(len(counts)) * round(step_s * 1000), counts)


def wheel_ticks(drive: Drive, metres_per_tick: float) -> IntArray:
    """Trip times of wheel ticks in units of 125 µs, shape (n,): one per so many metres, none below walking pace."""
    count = int(drive.distance_m[-1] / metres_per_tick)
    moving = np.concatenate([[True], np.diff(drive.distance_m) > 0])
    t = np.interp(np.arange(1, count + 1) * metres_per_tick, drive.distance_m[moving], drive.t_s[moving])
    fast = np.interp(t, drive.t_s, drive.speed_mps) > TICK_MIN_SPEED_MPS
    return np.asarray(np.floor(t[fast] * 8000.0), dtype=np.int64)


def injector_pulses(drive: Drive, vehicle: Vehicle) -> Pulses:
    """One pulse per engine cycle that got fuel, carrying the energy burned since the pulse before.

    So the pulses' energies, summed up to a pulse, are the fuel energy at its time. Cycles without fuel (overrun, engine
    off) have no pulse; what little a cycle got beside a fuel cut goes with the next pulse.

    Raises
    ------
    ScienceError
        When the injectors are too small for the engine: a pulse would not fit the logger's 16 bits.
    """
    per_pulse = angle_per_pulse_rad(vehicle)
    turning = np.concatenate([[True], np.diff(drive.engine_angle_rad) > 0])
    angles = np.arange(1, int(drive.engine_angle_rad[-1] / per_pulse) + 1) * per_pulse
    t = np.interp(angles, drive.engine_angle_rad[turning], drive.t_s[turning])
    energy = np.interp(t, drive.t_s, drive.fuel_energy_j)
    idle_w = drive.fuel_power_w[drive.fuel_power_w > 0].min(initial=np.inf)
    fuelled = np.diff(energy, prepend=0.0) > 0.5 * idle_w * np.diff(t, prepend=0.0)
    t, energy = t[fuelled], np.diff(energy[fuelled], prepend=0.0)
    seconds = energy / open_power_w(vehicle) - vehicle.injection.lag_s
    counts = np.asarray(np.rint(seconds / PULSE_COUNT_S), dtype=np.int64)
    if counts.max(initial=0) > 0xFFFF:
        raise ScienceError(
            f"The injectors are too small for this engine: a pulse would last {counts.max() * PULSE_COUNT_S * 1e3:.1f} "
            "ms, the logger counts up to 16.4 ms. Give the car a larger fuelPerSecond."
        )
    return Pulses(np.asarray(np.floor(t * 1000.0), dtype=np.int64), counts)
