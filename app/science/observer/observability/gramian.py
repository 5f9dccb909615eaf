"""What the measurements of a real trip tell, minute by minute: the observability Gramian along its trajectory.

W = Σ Φ(t, t₀)ᵀ Hᵀ R⁻¹ H Φ(t, t₀) over the measurements that the filter took in. It asks what a window by itself tells
of the state at its beginning if nothing but the model moves the car, so its standard deviations are the least that
any observer could reach from that window; the observer, whose thrust may wander, has the windows around it instead.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.observer import motion_kernels as motion
from app.science.observer.events import MOTION_SENSORS
from app.science.observer.motion_kernels import KINDS, SIZE, V
from app.science.observer.observability.linear import dynamics, measurement_rows, own_axes
from app.science.observer.result import Observation
from app.science.observer.states import STATE_COLUMNS, State
from app.science.observer.tuning import Tuning
from app.science.vehicle.model import Vehicle

WINDOW_S = 60.0
STEP_S = 0.1
MOTION_STATES = [*range(State.FUEL_ENERGY), State.BIAS_I, State.BIAS_J, State.BIAS_K]
"""Where the motion block's 13 states stand among the 17."""
PAIRS = {State.FUEL_ENERGY: ("fuel_energy", "fuel_power"), State.ENGINE_ANGLE: ("engine_angle", "engine_speed")}
SLOWEST_TURNING_MPS = 2.0


@dataclass(frozen=True, slots=True)
class Information:
    """What the measurements of each window tell of the state at its beginning.

    Attributes
    ----------
    begin_s : array, shape (windows,)
    gramian : array, shape (windows, 17, 17)
    """

    begin_s: FloatArray
    gramian: FloatArray

    def sd(self, prior_sd: FloatArray) -> FloatArray:
        """Return standard deviations (windows, 17) of somebody who knew ``prior_sd`` (17,) and saw the window."""
        both = self.gramian * prior_sd[:, None] * prior_sd[None, :] + np.eye(len(prior_sd))
        size = np.sqrt(np.diagonal(both, axis1=1, axis2=2))
        # states known a million times better than others lose no digits once all have the same size
        even = np.linalg.inv(both / size[:, :, None] / size[:, None, :])
        return np.asarray(np.sqrt(np.maximum(np.diagonal(even, axis1=1, axis2=2), 1.0)) / size * prior_sd)


@dataclass(frozen=True, slots=True)
class _Steps:
    """A trip on a coarse grid: times (n,), motion states (n, 13), accelerated masses, windows and steps in them."""

    t_s: FloatArray
    x: FloatArray
    mass_a: FloatArray
    window: IntArray
    begin_s: FloatArray


def information_along(
    observation: Observation, vehicle: Vehicle, tuning: Tuning, *, window_s: float = WINDOW_S, step_s: float = STEP_S
) -> Information:
    """Return the Gramian of each window of a trip.

    Parameters
    ----------
    observation : Observation
        Gives the trajectory, and when which measurement was taken in.
    vehicle : Vehicle
    tuning : Tuning
        Gives the measurements' variances; that of a position fix is taken at HDOP 1.
    window_s : float
    step_s : float
        Measurements count at the nearest multiple of this.
    """
    steps = _steps(observation, vehicle, window_s, step_s)
    gramian = np.zeros((len(steps.begin_s), len(State), len(State)))
    gramian[np.ix_(range(len(gramian)), MOTION_STATES, MOTION_STATES)] = _motion(
        steps, _weights(observation, steps, vehicle, tuning), vehicle
    )
    for level, names in PAIRS.items():
        gramian[:, level : level + 2, level : level + 2] = _pair(observation, names, steps, tuning)
    return Information(steps.begin_s, gramian)


def _steps(observation: Observation, vehicle: Vehicle, window_s: float, step_s: float) -> _Steps:
    columns = observation.columns
    t = columns["t_s"]
    number = np.round((t - t[0]) / step_s).astype(np.int64)
    chosen = np.flatnonzero(np.diff(number, prepend=-1) > 0)
    x = np.column_stack([columns[STATE_COLUMNS[state]][chosen] for state in MOTION_STATES])
    gear = np.nan_to_num(columns["gear"][chosen]).astype(np.int64)
    masses = np.array([vehicle.accelerated_mass_kg(gear) for gear in range(len(vehicle.gear_ratios) + 1)])
    last = max(round(number[-1] * step_s / window_s), 1) - 1
    at = np.minimum((number[chosen] * step_s / window_s + 1e-9).astype(np.int64), last)
    windows, window = np.unique(at, return_inverse=True)
    return _Steps(
        t[chosen], np.nan_to_num(x), masses[np.clip(gear, 0, len(masses) - 1)], window, t[0] + windows * window_s
    )


def _weights(observation: Observation, steps: _Steps, vehicle: Vehicle, tuning: Tuning) -> FloatArray:
    """Return the sum of 1/R of each kind of measurement at each step, shape (steps, kinds)."""
    seen = observation.innovations
    kinds = {name: kind for kind, name in MOTION_SENSORS.items()}
    kind_of = np.array([kinds.get(name, -1) for name in seen.sensors])
    kind = kind_of[seen.sensor]
    taken = (seen.accepted == 1) & (kind >= 0)
    step = _nearest(steps.t_s, seen.t_s[taken])
    counts = np.bincount(step * KINDS + kind[taken], minlength=len(steps.t_s) * KINDS).reshape(-1, KINDS)
    return np.asarray(counts / _variances(observation, steps, vehicle, tuning))


def _nearest(grid: FloatArray, t: FloatArray) -> IntArray:
    after = np.clip(np.searchsorted(grid, t), 1, len(grid) - 1)
    return np.asarray(after - (t - grid[after - 1] < grid[after] - t), np.int64)


def _variances(observation: Observation, steps: _Steps, vehicle: Vehicle, tuning: Tuning) -> FloatArray:
    v = np.abs(steps.x[:, V])
    r = np.ones((len(v), KINDS))
    for kind, variance in (
        (motion.DISTANCE, tuning.r_distance),
        (motion.SPEED, tuning.r_speed),
        (motion.STANDSTILL, tuning.r_standstill),
        (motion.HEADING, tuning.r_heading),
        (motion.PITCH, tuning.r_pitch),
        (motion.CURVATURE_H, tuning.r_curvature_h),
        (motion.YAW_RATE, tuning.r_yaw_rate),
        (motion.NORTH, tuning.r_gps_horizontal),
        (motion.EAST, tuning.r_gps_horizontal),
        (motion.ALTITUDE, tuning.r_gps_vertical),
        (motion.ROAD_ALTITUDE, tuning.r_road_altitude),
    ):
        r[:, kind] = variance
    for axis, name in enumerate("ijk"):
        floor, slope = (float(getattr(tuning, f"acc_{part}_{name}")) for part in ("floor", "slope"))
        r[:, motion.ACC_I + axis] = (floor + slope * v) ** 2
    axes = own_axes(vehicle)
    r[:, motion.ACC_X : motion.ACC_Z + 1] = r[:, motion.ACC_I : motion.ACC_K + 1] @ (axes**2).T
    omega = np.interp(steps.t_s, observation.columns["t_s"], observation.columns["engine_speed_radps"])
    per_torque = np.nan_to_num(omega, nan=1e6) / np.maximum(v, SLOWEST_TURNING_MPS)
    r[:, motion.THRUST] = tuning.r_engine_torque * np.maximum(per_torque, 1.0) ** 2
    return r


def _motion(steps: _Steps, weights: FloatArray, vehicle: Vehicle) -> FloatArray:
    """Return the motion block's Gramians (windows, 13, 13), all windows moving on together, step by step."""
    first = np.searchsorted(steps.window, np.arange(len(steps.begin_s)))
    length = np.diff(first, append=len(steps.window))
    told = np.flatnonzero(weights.any(axis=0))
    gramian = np.zeros((len(first), SIZE, SIZE))
    phi = np.tile(np.eye(SIZE), (len(first), 1, 1))
    for k in range(int(length.max())):
        going = np.flatnonzero(length > k)
        now = first[going] + k
        rows = measurement_rows(steps.x[now], vehicle, steps.mass_a[now])[:, told]
        seen = (rows * np.sqrt(weights[now][:, told])[:, :, None]) @ phi[going]
        gramian[going] += np.swapaxes(seen, 1, 2) @ seen
        going = np.flatnonzero(length > k + 1)
        phi[going] = _moved(phi[going], first[going] + k, steps, vehicle)
    return gramian


def _moved(phi: FloatArray, at: IntArray, steps: _Steps, vehicle: Vehicle) -> FloatArray:
    middle = 0.5 * (steps.x[at] + steps.x[at + 1])
    turned = (steps.t_s[at + 1] - steps.t_s[at])[:, None, None] * dynamics(middle, vehicle, steps.mass_a[at])
    once = turned @ phi
    return np.asarray(phi + once + 0.5 * (turned @ once))


def _pair(observation: Observation, names: tuple[str, str], steps: _Steps, tuning: Tuning) -> FloatArray:
    """Return the Gramians (windows, 2, 2) of a quantity and its rate, whose Φ is exact."""
    out = np.zeros((len(steps.begin_s), 2, 2))
    seen = observation.innovations
    level_r, rate_r = (float(getattr(tuning, f"r_{name}")) for name in names)
    for name, variance, is_level in ((names[0], level_r, True), (names[1], rate_r, False)):
        if name not in seen.sensors:
            continue
        t = seen.t_s[(seen.sensor == seen.sensors.index(name)) & (seen.accepted == 1)]
        window = steps.window[_nearest(steps.t_s, t)]
        since = t - steps.begin_s[window]
        sums = [np.bincount(window, since**power, len(out)) / variance for power in range(3)]
        if is_level:
            out += np.moveaxis(np.array([[sums[0], sums[1]], [sums[1], sums[2]]]), 2, 0)
        else:
            out[:, 1, 1] += sums[0]
    return out
