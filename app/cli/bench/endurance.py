"""A hundred hours of driving without a stop: does the filter's covariance stay symmetric, positive and bounded?

The drive is made of sines and circles, so that it costs next to nothing and its truth is known at any hour; each hour
ends with ten minutes without positions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.cli.bench.figure import Figure
from app.cli.output import note
from app.science.arrays import FloatArray
from app.science.observer import motion_kernels as mk
from app.science.observer.carry_over import START_SD_MPS2
from app.science.observer.events import MotionEvents
from app.science.observer.motion import CHECKPOINT_EVERY, diverged, gates, motion_model
from app.science.observer.motion_filter import filter_motion, filter_start
from app.science.observer.tuning import DEFAULT
from app.science.virtualcar.specification import DEFAULT_CAR

HOUR_S = 3600.0
HOURS = 100
FULL_RATE_HZ = 40.0
POSITIONS_END_S = 3000.0
GEAR = 5
SLOPE_RAD, SLOPES_M = 0.05, 2500.0
CIRCLE_M, SWING_RAD, SWINGS_M = 800.0, 0.4, 3000.0
BIAS_MPS2 = np.array([0.12, -0.1, 0.15])
START_VARIANCE = np.square([0.01, 1.0, 1000.0, 2.0, 0.06, 10.0, 10.0, 30.0, 0.01, 0.001, *[START_SD_MPS2] * 3])
MODEL = motion_model(DEFAULT_CAR, DEFAULT)
STATES = (
    (mk.V, "speed", "m/s"),
    (mk.F, "thrust", "N"),
    (mk.TH, "pitch", "rad"),
    (mk.D, "height", "m"),
    (mk.BI, "forward bias", "m/s²"),
)


@dataclass(frozen=True, slots=True)
class Health:
    """How the filter stands after some hours.

    Attributes
    ----------
    hours, events : int
        Driven so far.
    asymmetry : float
        Largest difference between two entries of the covariance that should be equal, over their standard deviations.
    smallest_eigenvalue : float
        Of the correlations; positive for a positive covariance.
    sd : array, shape (13,)
        Standard deviations.
    error : array, shape (13,)
        Truth minus estimate, over the standard deviations.
    """

    hours: int
    events: int
    asymmetry: float
    smallest_eigenvalue: float
    sd: FloatArray
    error: FloatArray


def drive(hours: int, rate_hz: float) -> Iterator[tuple[MotionEvents, FloatArray]]:
    """Give hour after hour: its events, and the true state (13,) at its end.

    Parameters
    ----------
    hours : int
    rate_hz : float
        Of accelerometer and wheel ticks; positions and nodes come once a second.
    """
    rng = np.random.default_rng(100)
    place = np.zeros(3)
    for hour in range(hours):
        t = hour * HOUR_S + np.arange(round(HOUR_S * rate_hz) + 1) / rate_hz
        truth = _truth(t, place)
        place = truth[-1, [mk.N, mk.E, mk.D]]
        yield _events(t, truth, int(rate_hz), rng), truth[-1]


def _truth(t: FloatArray, place: FloatArray) -> FloatArray:
    """Return the true states, shape (n, 13), from a place north, east, down on."""
    turn = 2.0 * np.pi / 200.0
    v, a = 20.0 + 8.0 * np.sin(turn * t), 8.0 * turn * np.cos(turn * t)
    s = 20.0 * t + 8.0 / turn * (1.0 - np.cos(turn * t))
    slope, swing = 2.0 * np.pi * s / SLOPES_M, 2.0 * np.pi * s / SWINGS_M
    pitch, heading = SLOPE_RAD * np.cos(slope), s / CIRCLE_M + SWING_RAD * (1.0 - np.cos(swing))
    curvature_k = -SLOPE_RAD * 2.0 * np.pi / SLOPES_M * np.sin(slope)
    curvature_j = 1.0 / CIRCLE_M + SWING_RAD * 2.0 * np.pi / SWINGS_M * np.sin(swing)
    weight = MODEL.mass * MODEL.gravity
    resist = MODEL.drag * v**2 + MODEL.crr * (weight * np.cos(pitch) + MODEL.mass * curvature_k * v**2)
    x = np.empty((len(t), mk.SIZE))
    x[:, mk.X], x[:, mk.V], x[:, mk.PSI], x[:, mk.TH] = s, v, heading, pitch
    x[:, mk.F] = MODEL.accelerated_mass[GEAR] * a + resist + weight * np.sin(pitch)
    x[:, mk.SJ], x[:, mk.SK], x[:, [mk.BI, mk.BJ, mk.BK]] = curvature_j, curvature_k, BIAS_MPS2
    ahead = np.column_stack([np.cos(heading) * np.cos(pitch), np.sin(heading) * np.cos(pitch), -np.sin(pitch)])
    moved = 0.5 * (ahead[1:] + ahead[:-1]) * np.diff(s)[:, None]
    x[:, [mk.N, mk.E, mk.D]] = place + np.vstack([np.zeros(3), np.cumsum(moved, axis=0)])
    return x


def _events(t: FloatArray, x: FloatArray, every: int, rng: np.random.Generator) -> MotionEvents:
    v, pitch, mass = x[:, mk.V], x[:, mk.TH], MODEL.mass / MODEL.accelerated_mass[GEAR]
    resist = MODEL.drag * v**2 + MODEL.crr * MODEL.mass * (MODEL.gravity * np.cos(pitch) + x[:, mk.SK] * v**2)
    forward = (x[:, mk.F] - resist) / MODEL.accelerated_mass[GEAR] + MODEL.gravity * (1.0 - mass) * np.sin(pitch)
    body = np.column_stack([forward, x[:, mk.SJ] * v**2, -MODEL.gravity * np.cos(pitch) - x[:, mk.SK] * v**2])
    body += BIAS_MPS2 + rng.standard_normal(body.shape) * (MODEL.acc_floor + np.outer(v, MODEL.acc_slope))
    seconds, seen = slice(every, None, every), t[every::every] - t[0] <= POSITIONS_END_S
    at, positions = t[seconds], x[seconds][seen]
    parts = [(mk.ACC_I + axis, t, body[:, axis], 1.0) for axis in range(3)]
    parts.append((mk.DISTANCE, t, x[:, mk.X] + 0.01 * rng.standard_normal(len(t)), DEFAULT.r_distance))
    for kind, value, sd, variance in (
        (mk.NORTH, positions[:, mk.N], 5.0, DEFAULT.r_gps_horizontal),
        (mk.EAST, positions[:, mk.E], 5.0, DEFAULT.r_gps_horizontal),
        (mk.ALTITUDE, -positions[:, mk.D], 10.0, DEFAULT.r_gps_vertical),
        (mk.ROAD_ALTITUDE, -positions[:, mk.D], 0.2, DEFAULT.r_road_altitude),
    ):
        parts.append((kind, at[seen], value + sd * rng.standard_normal(len(value)), variance))
    parts.append((mk.NODE, at, np.zeros(len(at)), 0.0))
    times = np.concatenate([part[1] for part in parts])
    order = np.argsort(times, kind="stable")
    return MotionEvents(
        times[order],
        np.concatenate([np.full(len(part[1]), part[0], np.int8) for part in parts])[order],
        np.concatenate([part[2] for part in parts])[order],
        np.concatenate([np.full(len(part[1]), part[3]) for part in parts])[order],
        np.full(len(times), GEAR, np.int8),
        np.zeros(len(times), np.int8),
    )


def endure(hours: int, rate_hz: float = FULL_RATE_HZ) -> Iterator[Health]:
    """Filter hour after hour as one drive, and tell how the filter stands after each.

    Raises
    ------
    EstimatorDiverged
        When a number stops being finite.
    """
    gate, patience, recovery = gates()
    every, done = CHECKPOINT_EVERY, 0
    x0 = _truth(np.zeros(1), np.zeros(3))[0] + np.sqrt(START_VARIANCE) * 0.5
    state = filter_start(x0, START_VARIANCE, 0.0)
    for hour, (events, truth) in enumerate(drive(hours, rate_hz), 1):
        n, nodes = len(events.t_s), round(HOUR_S)
        state.node[0] = 0
        failed = filter_motion(
            events.t_s, events.kind, events.y.copy(), events.r, events.gear, events.boosted, MODEL, START_VARIANCE,
            gate, patience, recovery, every, np.empty((n // every + 1, mk.SIZE)),
            np.empty((n // every + 1, mk.SIZE, mk.SIZE)), np.zeros(n, np.float32), np.zeros(n, np.float32),
            np.zeros(n, np.int8), np.empty((nodes, mk.SIZE)), np.empty((nodes, mk.SIZE)),
            np.empty((0, mk.SIZE, mk.SIZE)), 0, state, 0, n,
        )  # fmt: skip
        if failed >= 0:
            raise diverged(float(events.t_s[failed]))
        done += n
        yield _health(hour, done, state.x, state.p, truth)


def _health(hours: int, events: int, x: FloatArray, p: FloatArray, truth: FloatArray) -> Health:
    sd = np.sqrt(np.diag(p))
    correlation = p / np.outer(sd, sd)
    return Health(
        hours=hours,
        events=events,
        asymmetry=float(np.abs(correlation - correlation.T).max()),
        smallest_eigenvalue=float(np.linalg.eigvalsh(0.5 * (correlation + correlation.T)).min()),
        sd=sd,
        error=(truth - x) / sd,
    )


def measure() -> list[Figure]:
    """Return how the filter stands after a hundred hours beside how it stood after ten."""
    hours = []
    for health in endure(HOURS):
        hours.append(health)
        if health.hours % 10 == 0:
            note(f"{health.hours} h, {health.events} events, covariance asymmetric by {health.asymmetry:.1e}")
    tenth, last = hours[9], hours[-1]
    errors = np.array([np.abs(one.error).max() for one in hours])
    figures = [
        Figure(f"{name} after {HOURS} h, standard deviation", float(last.sd[state]), unit, float(tenth.sd[state]),
               "after 10 h", goal="as after 10 h")
        for state, name, unit in STATES
    ]  # fmt: skip
    smallest, before = last.smallest_eigenvalue, tenth.smallest_eigenvalue
    figures.append(
        Figure("smallest eigenvalue of the correlations", smallest, "1", before, "after 10 h", "higher", "above 0")
    )
    largest, before = float(errors[10:].max()), float(errors[:10].max())
    figures.append(Figure("largest error, in standard deviations", largest, "1", before, "of 10 h", goal="at most 5"))
    return figures
