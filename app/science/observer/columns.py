"""The columns of `states.parquet` from the three blocks."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.observer import motion_kernels as motion
from app.science.observer.events import MOTION_SENSORS
from app.science.observer.motion import MotionResult
from app.science.observer.pair import PairResult
from app.science.observer.prepass import FUEL_CUT_GAP_S
from app.science.observer.states import STATE_COLUMNS, State
from app.science.observer.timeline import Timeline
from app.science.roads.projection import LocalPlane

PROPELLING_W = 2000.0
TURNING_RADPS = 5.0
VAGUE = 0.10

_MOTION_STATE = {
    State.DISTANCE: motion.X,
    State.SPEED: motion.V,
    State.THRUST: motion.F,
    State.HEADING: motion.PSI,
    State.PITCH: motion.TH,
    State.NORTH: motion.N,
    State.EAST: motion.E,
    State.DOWN: motion.D,
    State.CURVATURE_H: motion.SJ,
    State.CURVATURE_V: motion.SK,
    State.BIAS_I: motion.BI,
    State.BIAS_J: motion.BJ,
    State.BIAS_K: motion.BK,
}


def state_columns(
    timeline: Timeline, moved: MotionResult, fuel: PairResult, engine: PairResult, plane: LocalPlane | None
) -> dict[str, FloatArray]:
    """Return every column by name, shape (nodes,); NaN where a quantity is not known.

    Efficiency (Sebesta 2010, 1.12) is known only where the engine propels the car: not below 2 kW, not while the
    drive of a car with known gears is open or changing, not where its standard deviation exceeds ten
    points, and never above 1, which would be a transient of the estimates.
    """
    nodes = len(timeline.node_t_s)
    columns: dict[str, FloatArray] = {"t_s": timeline.node_t_s}
    pairs = {
        State.FUEL_ENERGY: (fuel, 0),
        State.FUEL_POWER: (fuel, 1),
        State.ENGINE_ANGLE: (engine, 0),
        State.ENGINE_SPEED: (engine, 1),
    }
    for state in State:
        name = STATE_COLUMNS[state]
        if state in _MOTION_STATE:
            at = _MOTION_STATE[state]
            columns[name], variance = moved.state[:, at].copy(), moved.variance[:, at]
        else:
            pair, at = pairs[state]
            columns[name], variance = pair.state[:, at].copy(), pair.variance[:, at]
        columns[f"{name}_sd"] = np.sqrt(variance)
    columns["heading_rad"] %= 2.0 * np.pi
    t = timeline.node_t_s
    silent = (t < engine.told_from_s - FUEL_CUT_GAP_S) | (t > engine.told_to_s + FUEL_CUT_GAP_S)
    for name in (STATE_COLUMNS[State.ENGINE_ANGLE], STATE_COLUMNS[State.ENGINE_SPEED]):
        columns[name][silent] = columns[f"{name}_sd"][silent] = np.nan
    unknown = np.full(nodes, np.nan)
    if plane is None:
        for name in ("north_m", "east_m") if _headed(moved) else ("north_m", "east_m", "heading_rad"):
            columns[name] = columns[f"{name}_sd"] = unknown
        columns["lat_deg"] = columns["lon_deg"] = unknown
    else:
        at_deg = plane.inverse(columns["north_m"], columns["east_m"])
        columns["lat_deg"], columns["lon_deg"] = at_deg.lat_deg, at_deg.lon_deg
    columns["alt_m"] = -columns["down_m"]
    power = columns["thrust_n"] * columns["speed_mps"]
    omega = columns["engine_speed_radps"]
    columns["torque_nm"] = np.divide(power, omega, out=np.full(nodes, np.nan), where=omega > TURNING_RADPS)
    columns["power_w"] = power
    columns["gear"] = timeline.gear.astype(np.float64)
    columns["efficiency"] = _efficiency(columns, timeline)
    return columns


def _headed(moved: MotionResult) -> bool:
    """Whether anything measured the heading itself."""
    told = moved.innovations
    return bool(np.any(told.sensor == told.sensors.index(MOTION_SENSORS[motion.HEADING])))


def _efficiency(columns: dict[str, FloatArray], timeline: Timeline) -> FloatArray:
    power, fuel_power = columns["power_w"], columns["fuel_power_w"]
    open_clutch = np.any(timeline.gear > 0) & ((timeline.gear == 0) | timeline.changing)
    propels = (power > PROPELLING_W) & (fuel_power > power) & ~open_clutch
    efficiency = np.divide(power, fuel_power, out=np.full(len(power), np.nan), where=propels)
    relative_variance = np.zeros(len(power))
    for name in ("thrust_n", "speed_mps", "fuel_power_w"):
        relative = np.divide(columns[f"{name}_sd"], columns[name], out=np.zeros(len(power)), where=propels)
        relative_variance += relative**2
    vague = efficiency * np.sqrt(relative_variance) > VAGUE
    return np.where(vague, np.nan, efficiency)
