"""The motion block as a whole: start state, gates, filter and smoother over its events."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.errors import EstimatorDiverged
from app.science.logger.recording import Recording
from app.science.observer import motion_kernels as motion
from app.science.observer.carry_over import START_SD_MPS2, BiasPrior
from app.science.observer.events import MOTION_SENSORS, MotionEvents
from app.science.observer.late_fix import LATE_S, SIDEWAYS_BIAS_SD_MPS2, StartPose, start_pose
from app.science.observer.motion_filter import filter_motion, filter_start
from app.science.observer.motion_kernels import KINDS, SIZE, MotionModel
from app.science.observer.motion_smoother import smooth_motion, smoother_start
from app.science.observer.prepass import speed_before_filtering
from app.science.observer.result import Innovations
from app.science.observer.timeline import Timeline
from app.science.observer.tuning import Tuning
from app.science.progress import Progress, between, silent
from app.science.roads.projection import LocalPlane
from app.science.vehicle.model import Vehicle

CHECKPOINT_EVERY = 1024
STRETCHES_AT_ONCE = 100
"""Stretches between checkpoints worked on at a time: about a tenth of a second."""
FILTER_SHARE = 0.4
COURSE_LENGTH_M = 20.0
LATE_FIX_S = 5.0
SLOPES = 0.05
BIASES = [motion.BI, motion.BJ, motion.BK]


@dataclass(frozen=True, slots=True)
class MotionResult:
    """Motion states at the nodes and what the measurements said on the way.

    Attributes
    ----------
    state, variance : array, shape (nodes, 13)
    innovations : Innovations
    covariance : array, shape (m, 13, 13), or None
        Whole covariances at every `whole_every`-th node, where they were asked for.
    """

    state: FloatArray
    variance: FloatArray
    innovations: Innovations
    covariance: FloatArray | None = None


def motion_model(vehicle: Vehicle, tuning: Tuning) -> MotionModel:
    """Gather the numbers that the kernels need."""
    q = np.zeros(SIZE)
    for state, density in (
        (motion.X, tuning.q_distance),
        (motion.V, tuning.q_speed),
        (motion.F, tuning.q_thrust),
        (motion.PSI, tuning.q_heading),
        (motion.TH, tuning.q_pitch),
        (motion.N, tuning.q_north),
        (motion.E, tuning.q_east),
        (motion.D, tuning.q_down),
        (motion.SJ, tuning.q_curvature_h),
        (motion.SK, tuning.q_curvature_v),
        (motion.BI, tuning.q_bias_i),
        (motion.BJ, tuning.q_bias_j),
        (motion.BK, tuning.q_bias_k),
    ):
        q[state] = density
    masses = [vehicle.accelerated_mass_kg(gear) for gear in range(len(vehicle.gear_ratios) + 1)]
    return MotionModel(
        drag=vehicle.drag_area_kgpm,
        crr=vehicle.crr,
        mass=vehicle.mass_kg,
        gravity=vehicle.gravity_mps2,
        accelerated_mass=np.array(masses),
        q=np.concatenate([q, tuning.thrust_slope_noise]),
        curvature_v_exponent=tuning.curvature_v_exponent,
        unsteady_boost=tuning.unsteady_boost,
        acc_floor=np.array([tuning.acc_floor_i, tuning.acc_floor_j, tuning.acc_floor_k]),
        acc_slope=np.array([tuning.acc_slope_i, tuning.acc_slope_j, tuning.acc_slope_k]),
        acc_axes=np.ascontiguousarray(vehicle.mounting.matrix.T / vehicle.mounting.scale),
    )


def start_state(
    recording: Recording,
    vehicle: Vehicle,
    timeline: Timeline,
    plane: LocalPlane | None,
    bias_prior: BiasPrior | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return a start state (13,) and its variances (13,), read off the beginning of the recording.

    The biases start from what the car's earlier trips say of them, if anything.
    """
    x = np.zeros(SIZE)
    sd = np.array([0.01, 1.0, 1000.0, 2.0, 0.06, 10.0, 10.0, 30.0, 0.01, 0.001, *[START_SD_MPS2] * 3])
    if bias_prior is not None:
        x[BIASES], sd[BIASES] = bias_prior.mean, bias_prior.sd
    start = timeline.node_t_s[:1]
    speed = speed_before_filtering(start, recording, vehicle)
    if speed is None:
        sd[motion.V] = 15.0
    else:
        x[motion.V] = max(float(speed[0]), 0.0)
    altitude = recording.get("alt_m")
    if altitude is not None:
        x[motion.D] = -float(altitude.value[0])
    heading = recording.get("heading_deg")
    if plane is None and heading is not None and len(heading):
        x[motion.PSI], sd[motion.PSI] = np.radians(heading.value[0]), 0.4
    if plane is not None:
        lat, lon = recording["lat_deg"], recording["lon_deg"]
        at = plane.forward(lat.value, lon.value)
        far = np.flatnonzero(np.hypot(at.north_m - at.north_m[0], at.east_m - at.east_m[0]) > COURSE_LENGTH_M)
        if len(far):
            d_north, d_east = at.north_m[far[0]] - at.north_m[0], at.east_m[far[0]] - at.east_m[0]
            x[motion.PSI] = np.arctan2(d_east, d_north)
            sd[motion.PSI] = 0.4
        if lat.t_s[0] - start[0] > LATE_FIX_S:
            sd[motion.N] = sd[motion.E] = 200.0
        if lat.t_s[0] - start[0] > LATE_S:
            _go_back_to_the_start(x, sd, start_pose(recording, vehicle, timeline, float(lat.t_s[0]), x[motion.PSI]))
    return x, sd**2


def _go_back_to_the_start(x: FloatArray, sd: FloatArray, pose: StartPose | None) -> None:
    sd[motion.PSI] = 2.0
    if pose is None:
        return
    x[motion.PSI], x[motion.N], x[motion.E] = pose.heading_rad, pose.north_m, pose.east_m
    sd[motion.PSI], sd[motion.N], sd[motion.E] = pose.heading_sd_rad, pose.position_sd_m, pose.position_sd_m
    sd[motion.D] = np.hypot(sd[motion.D], SLOPES * pose.position_sd_m)
    if pose.bias_j_mps2 is not None and sd[motion.BJ] > SIDEWAYS_BIAS_SD_MPS2:
        x[motion.BJ], sd[motion.BJ] = pose.bias_j_mps2, SIDEWAYS_BIAS_SD_MPS2


def gates() -> tuple[FloatArray, AnyArray, FloatArray]:
    """Return per kind: squared gate, rejections in a row that are believed in the end, variance then added.

    A wheel's tick or speed outside its gate is believed at once, with speed and thrust set free: refusing it would
    cut the filter off from the one sensor that holds its speed.
    """
    gate = np.full(KINDS, 36.0)
    patience = np.full(KINDS, 20, np.int64)
    recovery = np.full(KINDS, 1.0)
    positions = [motion.NORTH, motion.EAST, motion.ALTITUDE, motion.ROAD_ALTITUDE]
    gate[positions], patience[positions], recovery[positions] = 25.0, 15, 1e4
    patience[[motion.DISTANCE, motion.SPEED]] = 0
    patience[motion.STANDSTILL] = 3
    patience[[motion.HEADING, motion.YAW_RATE]] = 5
    recovery[motion.STANDSTILL] = 25.0
    recovery[motion.THRUST] = 1e6
    recovery[[motion.ACC_J, motion.YAW_RATE]] = 1e-4
    recovery[motion.ACC_K] = 1e-6
    return gate, patience, recovery


def observe_motion(
    events: MotionEvents,
    model: MotionModel,
    x0: FloatArray,
    variance0: FloatArray,
    nodes: int,
    *,
    smooth: bool,
    whole_every: int = 0,
    progress: Progress = silent,
) -> MotionResult:
    """Filter and, if asked, smooth the motion block; keep the whole covariance at every so many nodes, 0 for none.

    Raises
    ------
    EstimatorDiverged
        When a number stops being finite.
    """
    n, every, at_once = len(events.t_s), CHECKPOINT_EVERY, STRETCHES_AT_ONCE
    gate, patience, recovery = gates()
    checkpoints = n // every + 1
    checkpoint_x = np.empty((checkpoints, SIZE))
    checkpoint_p = np.empty((checkpoints, SIZE, SIZE))
    innovation, innovation_sd = np.zeros(n, np.float32), np.zeros(n, np.float32)
    outcome = np.zeros(n, np.int8)
    node_x, node_variance = np.empty((nodes, SIZE)), np.empty((nodes, SIZE))
    node_p = np.empty((-(-nodes // whole_every) if whole_every else 0, SIZE, SIZE))
    y = events.y.copy()
    forwards = between(progress, 0.0, FILTER_SHARE if smooth else 1.0)
    filtered = filter_start(x0, variance0, float(events.t_s[0]) if n else 0.0)
    for first in range(0, n, every * at_once):
        forwards(first / n)
        failed = filter_motion(
            events.t_s, events.kind, y, events.r, events.gear, events.boosted, model, variance0,
            gate, patience, recovery, every, checkpoint_x, checkpoint_p,
            innovation, innovation_sd, outcome, node_x, node_variance, node_p, whole_every,
            filtered, first, min(first + every * at_once, n),
        )  # fmt: skip
        if failed >= 0:
            raise diverged(float(events.t_s[failed]))
    if smooth:
        backwards = between(progress, FILTER_SHARE, 1.0)
        smoothed = smoother_start(nodes)
        stretches = (n - 1) // every + 1
        for last in range(stretches, 0, -at_once):
            backwards(1.0 - last / stretches)
            smooth_motion(
                events.t_s, events.kind, y, events.r, events.gear, events.boosted, model, variance0, recovery,
                every, checkpoint_x, checkpoint_p, outcome, node_x, node_variance,
                node_p, whole_every, smoothed, max(last - at_once, 0), last,
            )  # fmt: skip
    innovations = innovations_of(events, innovation, innovation_sd, outcome)
    return MotionResult(node_x, node_variance, innovations, node_p if whole_every else None)


def diverged(t_s: float) -> EstimatorDiverged:
    return EstimatorDiverged(
        f"The filter's numbers stopped being finite at {t_s:.2f} s; look at the measurements just before it, "
        "the car's file and the tuning.",
        t_s,
    )


def innovations_of(events: MotionEvents, innovation: AnyArray, sd: AnyArray, outcome: AnyArray) -> Innovations:
    measured = events.kind > motion.REANCHOR
    number = np.zeros(KINDS, np.int8)
    number[list(MOTION_SENSORS)] = range(len(MOTION_SENSORS))
    return Innovations(
        events.t_s[measured],
        number[events.kind[measured]],
        innovation[measured],
        sd[measured],
        outcome[measured],
        tuple(MOTION_SENSORS.values()),
    )
