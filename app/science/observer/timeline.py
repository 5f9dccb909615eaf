"""What can be read off a recording before filtering: its time grid, the speed, the gear, and when the car stood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.logger.recording import Recording
from app.science.observer.body_axes import body_acceleration
from app.science.observer.gears import NODE_SPACING_S, read_gears
from app.science.observer.prepass import speed_before_filtering
from app.science.observer.receiver_speed import speed_is_the_receivers, standing
from app.science.vehicle.model import Vehicle

LONGEST_GAP_S = 60.0
RESTLESS_WITHIN_S = 0.4
RESTLESS_CHANGE_MPS2 = 0.5
SLOWEST_TICK_SPEED_MPS = 0.9
STANDSTILL_GAP_S = 2.0
SLOWEST_SHOWN_MPS = 0.05
STANDSTILL_MARGIN_S = 1.0


@dataclass(frozen=True, slots=True)
class Timeline:
    """Pre-pass over a recording on a regular grid of nodes.

    Attributes
    ----------
    node_t_s : array, shape (n,)
        Multiples of `NODE_SPACING_S`; none inside gaps longer than `LONGEST_GAP_S`.
    resume_t_s : array
        Times at which measurements start again after such a gap.
    gear : integer array, shape (n,)
        1, 2, … where engine and wheels turn in the ratio of that gear, else 0.
    changing : boolean array, shape (n,)
        Whether the drive through the gear may change: a shift, or the beginning or end of a fuel cut, is near.
    unsteady : boolean array, shape (n,)
        Whether thrust may change quickly: a change of gear is near, or the acceleration changes.
    lost_tick_t_s : array
        Times of wheel ticks before which ticks were lost, because the car was too slow for the sensor.
    standstill_t_s : array
        Nodes at which the car certainly stood.
    """

    node_t_s: FloatArray
    resume_t_s: FloatArray
    gear: IntArray
    changing: BoolArray
    unsteady: BoolArray
    lost_tick_t_s: FloatArray
    standstill_t_s: FloatArray


def build_timeline(recording: Recording, vehicle: Vehicle) -> Timeline:
    """Read the time grid, gears and standstills off a recording."""
    node_t, resume = _nodes(recording)
    gears = read_gears(node_t, recording, vehicle)
    lost, standstill = _standstills(node_t, recording, vehicle)
    unsteady = gears.changing | _restless(node_t, recording, vehicle)
    return Timeline(node_t, resume, gears.gear, gears.changing, unsteady, lost, standstill)


def _nodes(recording: Recording) -> tuple[FloatArray, FloatArray]:
    times = [s.t_s for name, s in recording.signals.items() if name != "utc_s" and len(s)]
    if not times:
        return np.zeros(0), np.zeros(0)
    # a coarse union of all sample times is enough to see where the recording pauses
    seconds = np.unique(np.concatenate([np.floor(t) for t in times]))
    breaks = np.flatnonzero(np.diff(seconds) > LONGEST_GAP_S)
    starts = seconds[np.concatenate(([0], breaks + 1))]
    ends = seconds[np.concatenate((breaks, [len(seconds) - 1]))] + 1.0
    first, last = min(float(t[0]) for t in times), max(float(t[-1]) for t in times)
    starts[0], ends[-1] = first, last
    grids = [
        np.arange(np.ceil(a / NODE_SPACING_S - 1e-9), np.floor(b / NODE_SPACING_S + 1e-9) + 1) * NODE_SPACING_S
        for a, b in zip(starts, ends, strict=True)
    ]
    return np.concatenate(grids), starts[1:]


def _restless(node_t: FloatArray, recording: Recording, vehicle: Vehicle) -> BoolArray:
    """Return where the acceleration, read off the ticks, changes by more than a steady drive's within a moment.

    Without ticks the accelerometer has to tell. Without either, or while the car is too slow for ticks, this can't be
    known, so every moment may be one.
    """
    ticks = recording.get("vss_tick")
    speed = speed_before_filtering(node_t, recording, vehicle)
    if ticks is None and speed_is_the_receivers(recording):
        return _felt_restless(node_t, recording, vehicle)
    if speed is None or ticks is None or len(ticks) < 2:
        return np.ones(len(node_t), np.bool_)
    after = np.clip(np.searchsorted(ticks.t_s, node_t), 1, len(ticks) - 1)
    slow = np.diff(ticks.t_s)[after - 1] > vehicle.vss_m_per_tick / SLOWEST_TICK_SPEED_MPS
    half = round(RESTLESS_WITHIN_S / NODE_SPACING_S)
    ahead = np.concatenate((speed[half:], np.full(min(half, len(speed)), speed[-1])))[: len(speed)]
    behind = np.concatenate((np.full(min(half, len(speed)), speed[0]), speed[:-half]))[: len(speed)]
    change = np.abs(ahead - 2.0 * speed + behind) / RESTLESS_WITHIN_S
    change[slow | (node_t < ticks.t_s[0]) | (node_t > ticks.t_s[-1])] = np.inf
    return np.asarray(maximum_filter1d(change, half) > RESTLESS_CHANGE_MPS2)


def _felt_restless(node_t: FloatArray, recording: Recording, vehicle: Vehicle) -> BoolArray:
    acceleration = body_acceleration(recording, vehicle)
    if acceleration is None or len(acceleration[0]) < 2:
        return np.ones(len(node_t), np.bool_)
    t, body = acceleration
    gained = np.concatenate(([0.0], np.cumsum(0.5 * (body[1:, 0] + body[:-1, 0]) * np.diff(t))))
    ahead, at, behind = (np.interp(node_t + d, t, gained) for d in (RESTLESS_WITHIN_S, 0.0, -RESTLESS_WITHIN_S))
    change = np.abs(ahead - 2.0 * at + behind) / RESTLESS_WITHIN_S
    change[(node_t < t[0]) | (node_t > t[-1])] = np.inf
    half = round(RESTLESS_WITHIN_S / NODE_SPACING_S)
    return np.asarray(maximum_filter1d(change, half) > RESTLESS_CHANGE_MPS2)


def _standstills(node_t: FloatArray, recording: Recording, vehicle: Vehicle) -> tuple[FloatArray, FloatArray]:
    """Return the ticks before which ticks were lost, and the nodes at which the car certainly stood."""
    ticks = recording.get("vss_tick")
    speed = recording.get("speed_mps")
    if ticks is not None and len(ticks) > 1:
        slow = np.diff(ticks.t_s) > vehicle.vss_m_per_tick / SLOWEST_TICK_SPEED_MPS
        edges = np.concatenate(([node_t[0] - STANDSTILL_GAP_S], ticks.t_s, [node_t[-1] + STANDSTILL_GAP_S]))
        after = np.clip(np.searchsorted(edges, node_t, side="right"), 1, len(edges) - 1)
        gap = edges[after] - edges[after - 1]
        margin = np.clip(0.25 * gap, STANDSTILL_MARGIN_S, 2.0)
        stood = (gap > STANDSTILL_GAP_S) & (node_t > edges[after - 1] + margin) & (node_t < edges[after] - margin)
        return ticks.t_s[1:][slow], node_t[stood]
    if speed is not None and len(speed) > 1:
        after = np.clip(np.searchsorted(speed.t_s, node_t), 1, len(speed) - 1)
        still = speed.value < SLOWEST_SHOWN_MPS
        often = np.diff(speed.t_s)[after - 1] < STANDSTILL_GAP_S
        return np.zeros(0), node_t[still[after] & still[after - 1] & often & (node_t <= speed.t_s[-1])]
    if speed_is_the_receivers(recording):
        return np.zeros(0), node_t[standing(node_t, recording["gnss_speed_mps"])]
    return np.zeros(0), np.zeros(0)
