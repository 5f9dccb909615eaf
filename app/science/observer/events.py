"""From measurement streams to the filter's motion events: scalar, sorted by time, in body axes and the local plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.logger.recording import ACCELEROMETER, Recording
from app.science.observer import motion_kernels as motion
from app.science.observer.body_axes import body_acceleration, gyroscope_bias, yaw_rate
from app.science.observer.gears import NODE_SPACING_S
from app.science.observer.prepass import engine_speed_before_filtering, speed_before_filtering
from app.science.observer.receiver_speed import standing
from app.science.observer.timeline import Timeline
from app.science.observer.tuning import Tuning
from app.science.roads.elevation import RoadElevation
from app.science.roads.projection import LocalPlane
from app.science.vehicle.model import Vehicle

MOTION_SENSORS: dict[int, str] = {
    motion.DISTANCE: "vss",
    motion.SPEED: "speed",
    motion.ACC_I: "acc_i",
    motion.ACC_J: "acc_j",
    motion.ACC_K: "acc_k",
    motion.HEADING: "heading",
    motion.PITCH: "pitch",
    motion.CURVATURE_H: "curvature_h",
    motion.YAW_RATE: "yaw_rate",
    motion.NORTH: "gps_north",
    motion.EAST: "gps_east",
    motion.ALTITUDE: "gps_altitude",
    motion.ROAD_ALTITUDE: "dem_altitude",
    motion.THRUST: "engine_torque",
    motion.STANDSTILL: "standstill",
    motion.ACC_X: "acc_x",
    motion.ACC_Y: "acc_y",
    motion.ACC_Z: "acc_z",
}
"""Name of the sensor behind each kind of motion event."""

TELL_HEIGHT = ("alt_m", "road_alt_m", "pitch_rad")
ONLY_DOWN_TELLS_SLOPE = 4.0
"""Factor on the downward accelerometer's variance where nothing else tells how steep the road is on the whole: what
it says of that, by the cosine of the slope, rests on the estimated slope itself and convinces a filter too easily."""
LOST_TICKS_VARIANCE_M2 = 1.0
SLOWEST_HEADING_MPS = 5.0
SLOWEST_THRUST_MPS = 2.0
SLOWEST_ENGINE_RADPS = 50.0


@dataclass(frozen=True, slots=True)
class MotionEvents:
    """Scalar events of the motion block, every array of shape (n,), sorted by time."""

    t_s: FloatArray
    kind: AnyArray
    y: FloatArray
    r: FloatArray
    gear: AnyArray
    boosted: AnyArray

    def between(self, first: int, last: int) -> MotionEvents:
        """Return the events from one index up to another."""
        part = slice(first, last)
        return MotionEvents(
            self.t_s[part], self.kind[part], self.y[part], self.r[part], self.gear[part], self.boosted[part]
        )


class _Collector:
    """Gathers measurements of one kind after another; those without a finite value are left out."""

    def __init__(self) -> None:
        self.t: list[FloatArray] = []
        self.kind: list[AnyArray] = []
        self.y: list[FloatArray] = []
        self.r: list[FloatArray] = []

    def add(self, kind: int, t: FloatArray, y: FloatArray | float, r: FloatArray | float) -> None:
        value, variance = np.broadcast_to(y, t.shape), np.broadcast_to(r, t.shape)
        good = np.isfinite(value) & np.isfinite(variance)
        if not good.all():
            t, value, variance = t[good], value[good], variance[good]
        self.t.append(t)
        self.kind.append(np.broadcast_to(np.int8(kind), t.shape))
        self.y.append(value)
        self.r.append(variance)

    def sorted(self, timeline: Timeline) -> MotionEvents:
        t = np.concatenate(self.t)
        order = np.argsort(t, kind="stable")
        t = t[order]
        near = np.clip(np.searchsorted(timeline.node_t_s, t), 0, len(timeline.node_t_s) - 1)
        return MotionEvents(
            t,
            np.concatenate(self.kind)[order],
            np.concatenate(self.y)[order],
            np.concatenate(self.r)[order],
            timeline.gear[near].astype(np.int8),
            timeline.unsteady[near].astype(np.int8),
        )


def motion_events(
    recording: Recording,
    vehicle: Vehicle,
    timeline: Timeline,
    tuning: Tuning,
    plane: LocalPlane | None,
    elevation: RoadElevation | None,
) -> MotionEvents:
    """Collect every measurement of the 13 motion states as scalar events sorted by time."""
    events = _Collector()
    events.add(motion.RESET, timeline.resume_t_s, 0.0, 0.0)
    events.add(motion.REANCHOR, timeline.lost_tick_t_s, 0.0, LOST_TICKS_VARIANCE_M2)
    ticks = recording.get("vss_tick")
    if ticks is not None:
        distance = np.cumsum(ticks.value) * vehicle.vss_m_per_tick
        events.add(motion.DISTANCE, ticks.t_s, distance, tuning.r_distance)
    events.add(motion.STANDSTILL, timeline.standstill_t_s, 0.0, tuning.r_standstill)
    _add_accelerations(events, recording, vehicle)
    _add_directly_measured(events, recording, vehicle, tuning)
    _add_turning(events, recording, vehicle, timeline, tuning)
    if plane is not None:
        _add_positions(events, recording, tuning, plane, elevation)
    events.add(motion.NODE, timeline.node_t_s, 0.0, 0.0)
    return events.sorted(timeline)


def _add_accelerations(events: _Collector, recording: Recording, vehicle: Vehicle) -> None:
    """Add what the accelerometer reads along the body's axes; lacking one of its own, along those it has."""
    acceleration = body_acceleration(recording, vehicle)
    if acceleration is not None:
        t, body = acceleration
        down = 1.0 if any(name in recording for name in TELL_HEIGHT) else ONLY_DOWN_TELLS_SLOPE
        for axis, (kind, factor) in enumerate(((motion.ACC_I, 1.0), (motion.ACC_J, 1.0), (motion.ACC_K, down))):
            events.add(kind, t, body[:, axis], factor)
        return
    for name, kind in zip(ACCELEROMETER, (motion.ACC_X, motion.ACC_Y, motion.ACC_Z), strict=True):
        if name in recording:
            events.add(kind, recording[name].t_s, vehicle.mounting.scale * recording[name].value, 1.0)


def _add_directly_measured(events: _Collector, recording: Recording, vehicle: Vehicle, tuning: Tuning) -> None:
    speed = recording.get("speed_mps")
    if speed is not None:
        events.add(motion.SPEED, speed.t_s, speed.value * vehicle.speed_scale, tuning.r_speed)
    if "vss_tick" not in recording:
        doppler = recording.get("gnss_speed_mps")
        if doppler is not None:
            driving = ~standing(doppler.t_s, doppler) if speed is None else np.ones(len(doppler), np.bool_)
            events.add(motion.SPEED, doppler.t_s[driving], doppler.value[driving], tuning.r_gnss_speed)
    pitch = recording.get("pitch_rad")
    if pitch is not None:
        events.add(motion.PITCH, pitch.t_s, pitch.value, tuning.r_pitch)
    for name, kind in (("heading_deg", motion.HEADING), ("road_heading_deg", motion.HEADING)):
        heading = recording.get(name)
        now = None if heading is None else speed_before_filtering(heading.t_s, recording, vehicle)
        if heading is not None and now is not None:
            moving = now > SLOWEST_HEADING_MPS
            events.add(kind, heading.t_s[moving], np.radians(heading.value[moving]), tuning.r_heading)
    torque = recording.get("engine_torque_nm")
    if torque is not None:
        now = speed_before_filtering(torque.t_s, recording, vehicle)
        omega = engine_speed_before_filtering(torque.t_s, recording, vehicle)
        if now is not None and omega is not None:
            driving = (now > SLOWEST_THRUST_MPS) & (omega > SLOWEST_ENGINE_RADPS)
            per_torque = omega[driving] / now[driving]
            thrust = torque.value[driving] * per_torque
            events.add(motion.THRUST, torque.t_s[driving], thrust, tuning.r_engine_torque * per_torque**2)


def _add_turning(
    events: _Collector, recording: Recording, vehicle: Vehicle, timeline: Timeline, tuning: Tuning
) -> None:
    curvature = recording.get("road_curvature_radpm")
    if curvature is not None:
        events.add(motion.CURVATURE_H, curvature.t_s, curvature.value, tuning.r_curvature_h)
    rate = yaw_rate(recording, vehicle)
    if rate is not None:
        still = np.isin(np.round(rate.t_s / NODE_SPACING_S), np.round(timeline.standstill_t_s / NODE_SPACING_S))
        course = recording.get("heading_deg")
        speed = None if course is None else speed_before_filtering(course.t_s, recording, vehicle)
        bias = gyroscope_bias(rate, still, course, speed)
        events.add(motion.YAW_RATE, rate.t_s, rate.value - bias, tuning.r_yaw_rate)


def _add_positions(
    events: _Collector,
    recording: Recording,
    tuning: Tuning,
    plane: LocalPlane,
    elevation: RoadElevation | None,
) -> None:
    lat, lon = recording["lat_deg"], recording["lon_deg"]
    position = plane.forward(lat.value, lon.value)
    squared_hdop = _at(recording, "hdop", lat.t_s, 1.0) ** 2
    events.add(motion.NORTH, lat.t_s, position.north_m, squared_hdop * tuning.r_gps_horizontal)
    events.add(motion.EAST, lat.t_s, position.east_m, squared_hdop * tuning.r_gps_horizontal)
    altitude = recording.get("alt_m")
    if altitude is not None:
        variance = _at(recording, "hdop", altitude.t_s, 1.0) ** 2 * tuning.r_gps_vertical
        events.add(motion.ALTITUDE, altitude.t_s, altitude.value, variance)
    if elevation is not None:
        road = elevation.lookup(lat.value, lon.value)
        events.add(motion.ROAD_ALTITUDE, lat.t_s, road.alt_m, tuning.r_road_altitude)
    known = recording.get("road_alt_m")
    if known is not None:
        events.add(motion.ROAD_ALTITUDE, known.t_s, known.value, tuning.r_road_altitude)


def _at(recording: Recording, name: str, t_s: FloatArray, otherwise: float) -> FloatArray:
    found = recording.get(name)
    if found is None or not len(found):
        return np.full(len(t_s), otherwise)
    return np.maximum(np.interp(t_s, found.t_s, found.value), 0.5)
