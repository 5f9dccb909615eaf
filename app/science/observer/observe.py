"""The observer: a trip's measurement streams in, its 17 states with uncertainty out."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import EstimatorDiverged, TooLittleData
from app.science.logger.recording import ACCELEROMETER, Recording
from app.science.observer import motion_kernels as motion
from app.science.observer.consistency import consistency, verdict_of
from app.science.observer.engine_events import Part, engine_speed_events, fuel_events, merged
from app.science.observer.events import MOTION_SENSORS, motion_events
from app.science.observer.motion import MotionResult, motion_model, observe_motion, start_state
from app.science.observer.motion_passes import ACCEPTED
from app.science.observer.pair_kernels import PAIR_LEVEL, PAIR_RATE, filter_pair
from app.science.observer.result import Innovations, Observation
from app.science.observer.states import STATE_COLUMNS, State
from app.science.observer.timeline import Timeline, build_timeline
from app.science.observer.tuning import DEFAULT, Tuning
from app.science.roads.elevation import RoadElevation
from app.science.roads.projection import LocalPlane
from app.science.vehicle.model import Vehicle

PROPELLING_W = 2000.0
TURNING_RADPS = 5.0
SENSOR_SIGNALS: dict[str, frozenset[str]] = {
    "gps": frozenset({"lat_deg", "lon_deg", "alt_m", "hdop", "heading_deg", "gnss_speed_mps", "satellites"}),
    "dem": frozenset({"road_alt_m", "road_heading_deg"}),
    "acc": frozenset(ACCELEROMETER),
    "vss": frozenset({"vss_tick", "speed_mps"}),
    "inj": frozenset({"injector_pulse_s", "fuel_rate_lph", "engine_speed_rpm", "maf_gps", "engine_torque_nm"}),
}
"""What each name of ``without`` leaves out."""

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


def observe(
    recording: Recording,
    vehicle: Vehicle,
    *,
    elevation: RoadElevation | None = None,
    tuning: Tuning = DEFAULT,
    filter: str = "ekf",  # noqa: A002 - the name the contract gives it
    smooth: bool = True,
    without: frozenset[str] = frozenset(),
) -> Observation:
    """Estimate the states of Sebesta 2010, (1.15), over a whole trip.

    Parameters
    ----------
    recording : Recording
        Measurement streams, raw sensor axes.
    vehicle : Vehicle
    elevation : RoadElevation, optional
        Altitudes along roads; looked up at each position fix.
    tuning : Tuning
    filter : str
        ``ekf``, the continuous-discrete extended Kalman filter.
    smooth : bool
        Whether a fixed-interval smoother follows, so that every state knows the whole trip.
    without : set of {"gps", "dem", "acc", "vss", "inj"}
        Sensors to leave out.

    Raises
    ------
    TooLittleData
        When nothing tells how the car moved.
    EstimatorDiverged
        When the filter's numbers stop being finite.
    """
    if filter != "ekf":
        raise TooLittleData(f"There is no filter called {filter!r}; use 'ekf'.")
    unknown = without - SENSOR_SIGNALS.keys()
    if unknown:
        raise TooLittleData(f"There is no sensor called {sorted(unknown)[0]!r}; use {', '.join(SENSOR_SIGNALS)}.")
    recording = recording.without({name for sensor in without for name in SENSOR_SIGNALS[sensor]})
    if "dem" in without:
        elevation = None
    if not any(name in recording for name in ("vss_tick", "speed_mps", "gnss_speed_mps", "lat_deg")):
        raise TooLittleData(
            "Nothing in this recording tells how the car moved: it has no wheel ticks, no speed and no positions. "
            f"It holds {', '.join(sorted(recording)) or 'no signal at all'}."
        )
    timeline = build_timeline(recording, vehicle)
    if len(timeline.node_t_s) < 2:
        raise TooLittleData("The recording is shorter than a tenth of a second.")
    plane = None
    if "lat_deg" in recording and "lon_deg" in recording:
        plane = LocalPlane(float(recording["lat_deg"].value[0]), float(recording["lon_deg"].value[0]))
    events = motion_events(recording, vehicle, timeline, tuning, plane, elevation)
    x0, variance0 = start_state(recording, vehicle, timeline, plane)
    moved = observe_motion(events, motion_model(vehicle, tuning), x0, variance0, len(timeline.node_t_s), smooth=smooth)
    fuel = _observe_pair(
        fuel_events(recording, vehicle, tuning, timeline.node_t_s),
        timeline, tuning.q_fuel_energy, tuning.q_fuel_power, smooth, "fuel_energy", "fuel_power",
    )  # fmt: skip
    engine = _observe_pair(
        engine_speed_events(recording, vehicle, tuning),
        timeline, tuning.q_engine_angle, tuning.q_engine_speed, smooth, "engine_angle", "engine_speed",
    )  # fmt: skip
    columns = _columns(timeline, moved, fuel, engine, plane)
    measured = moved.measured
    kinds = sorted(MOTION_SENSORS)
    innovations = _joined(
        Innovations(
            events.t_s[measured],
            np.searchsorted(kinds, events.kind[measured]),
            moved.innovation[measured].astype(np.float64),
            moved.innovation_sd[measured].astype(np.float64),
            (moved.outcome[measured] == ACCEPTED).astype(np.int64),
            tuple(MOTION_SENSORS[kind] for kind in kinds),
        ),
        fuel.innovations,
        engine.innovations,
    )
    sensors = consistency(innovations)
    verdict, reasons = verdict_of(sensors, columns)
    fuel_energy = columns["fuel_energy_j"]
    fuel_j = float(fuel_energy[-1] - fuel_energy[0]) if np.isfinite(fuel_energy).all() else float("nan")
    return Observation(
        columns=columns,
        innovations=innovations,
        sensors=sensors,
        verdict=verdict,
        reasons=reasons,
        warnings=recording.warnings,
        events=len(np.unique(innovations.t_s)),
        duration_s=float(timeline.node_t_s[-1] - timeline.node_t_s[0]),
        distance_m=float(columns["distance_m"][-1] - columns["distance_m"][0]),
        fuel_energy_j=fuel_j,
        fuel_l=fuel_j / vehicle.fuel_energy_j_per_l,
        filter=filter,
        tuning=tuning.name,
        smoothed=smooth,
    )


class _Pair:
    """A level and its rate at the nodes; NaN where no sensor tells."""

    def __init__(self, state: FloatArray, variance: FloatArray, innovations: Innovations | None) -> None:
        self.state = state
        self.variance = variance
        self.innovations = innovations


def _observe_pair(
    parts: list[Part], timeline: Timeline, q_level: float, q_rate: float, smooth: bool, level: str, rate: str
) -> _Pair:
    nodes = len(timeline.node_t_s)
    if not parts:
        return _Pair(np.full((nodes, 2), np.nan), np.full((nodes, 2), np.nan), None)
    t, kind, y, r = merged(parts, timeline.node_t_s)
    innovation, innovation_sd = np.zeros(len(t)), np.zeros(len(t))
    state, variance = np.empty((nodes, 2)), np.empty((nodes, 2))
    failed = filter_pair(t, kind, y, r, q_level, q_rate, 1.0, 1e12, smooth, innovation, innovation_sd, state, variance)
    if failed >= 0:
        raise EstimatorDiverged(f"The {rate} filter stopped being finite at {t[failed]:.2f} s.", float(t[failed]))
    told = (kind == PAIR_LEVEL) | (kind == PAIR_RATE)
    which = (kind[told] == PAIR_RATE).astype(np.int64)
    ones = np.ones(len(which), np.int64)
    return _Pair(
        state, variance, Innovations(t[told], which, innovation[told], innovation_sd[told], ones, (level, rate))
    )


def _joined(*parts: Innovations | None) -> Innovations:
    present = [part for part in parts if part is not None]
    names: list[str] = []
    sensor = []
    for part in present:
        sensor.append(part.sensor + len(names))
        names.extend(part.sensors)
    return Innovations(
        np.concatenate([part.t_s for part in present]),
        np.concatenate(sensor),
        np.concatenate([part.innovation for part in present]),
        np.concatenate([part.sd for part in present]),
        np.concatenate([part.accepted for part in present]),
        tuple(names),
    )


def _columns(
    timeline: Timeline, moved: MotionResult, fuel: _Pair, engine: _Pair, plane: LocalPlane | None
) -> dict[str, FloatArray]:
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
    unknown = np.full(nodes, np.nan)
    if plane is None:
        for name in ("north_m", "east_m", "heading_rad"):
            columns[name] = columns[f"{name}_sd"] = unknown
        columns["lat_deg"] = columns["lon_deg"] = unknown
    else:
        at_deg = plane.inverse(columns["north_m"], columns["east_m"])
        columns["lat_deg"], columns["lon_deg"] = at_deg.lat_deg, at_deg.lon_deg
    columns["alt_m"] = -columns["down_m"]
    power = columns["thrust_n"] * columns["speed_mps"]
    fuel_power, omega = columns["fuel_power_w"], columns["engine_speed_radps"]
    columns["torque_nm"] = np.divide(power, omega, out=np.full(nodes, np.nan), where=omega > TURNING_RADPS)
    # more work than fuel is a transient of the estimates, not an efficiency
    propels = (power > PROPELLING_W) & (fuel_power > power)
    columns["efficiency"] = np.divide(power, fuel_power, out=np.full(nodes, np.nan), where=propels)
    columns["power_w"] = power
    columns["gear"] = timeline.gear.astype(np.float64)
    return columns
