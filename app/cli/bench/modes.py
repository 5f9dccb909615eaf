"""What sensors can lack, or have beside the logger's own: a virtual trip with some taken away or given to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from app.science.arrays import FloatArray
from app.science.logger.recording import ACCELEROMETER, GYROSCOPE, Recording, Series, series
from app.science.observer.observe import SENSOR_SIGNALS
from app.science.virtualcar.simulate import SimulatedTrip

Mode = Callable[[Recording, SimulatedTrip], Recording]

TUNNEL_S = 180.0
GARAGE_S = 240.0
GYROSCOPE_STEP_S = 0.02
GYROSCOPE_SD_RADPS = 0.005
GYROSCOPE_BIAS_RADPS = (0.01, -0.02, 0.015)
COMPASS_STEP_S = 0.2
COMPASS_SD_RAD = 0.08
LEVEL_SD_RAD = 0.05


def lacking(*sensors: str) -> Mode:
    """Take whole sensors away, by the names of ``--without``."""
    names = {name for sensor in sensors for name in SENSOR_SIGNALS[sensor]}
    return lambda recording, trip: recording.without(names)


def lacking_axis(axis: str) -> Mode:
    """Take one axis of the accelerometer away."""
    return lambda recording, trip: recording.without({axis})


def without_fixes(begin_s: float, end_s: float, recording: Recording) -> Recording:
    """Take the receiver's signals away over a span of time."""
    kept: dict[str, Series] = dict(recording.signals)
    for name in SENSOR_SIGNALS["gps"] & kept.keys():
        own = kept[name]
        seen = (own.t_s < begin_s) | (own.t_s >= end_s)
        kept[name] = Series(own.t_s[seen], own.value[seen])
    return Recording(kept, recording.started_at_utc_s, recording.texts, recording.warnings)


def tunnel(recording: Recording, trip: SimulatedTrip) -> Recording:
    """Three minutes without the receiver in the middle of the trip."""
    middle = 0.5 * recording.duration_s
    return without_fixes(middle - 0.5 * TUNNEL_S, middle + 0.5 * TUNNEL_S, recording)


def garage(recording: Recording, trip: SimulatedTrip) -> Recording:
    """No fix in the first minutes."""
    return without_fixes(-np.inf, GARAGE_S, recording)


def with_gyroscope(recording: Recording, trip: SimulatedTrip) -> Recording:
    """Give a gyroscope that sits as the accelerometer does, with noise and a bias on each axis."""
    rng = np.random.default_rng(len(trip.image))
    t = np.arange(0.0, trip.truth["t_s"][-1], GYROSCOPE_STEP_S)
    v = _true("speed_mps", trip, t)
    turning = np.column_stack(
        [np.zeros(len(t)), _true("curvature_v_radpm", trip, t) * v, _true("curvature_h_radpm", trip, t) * v]
    )
    raw = turning @ (trip.vehicle.mounting.matrix / trip.vehicle.mounting.scale)
    raw += np.array(GYROSCOPE_BIAS_RADPS) + GYROSCOPE_SD_RADPS * rng.standard_normal(raw.shape)
    return _with(recording, {name: series(t, raw[:, axis]) for axis, name in enumerate(GYROSCOPE)})


def with_compass(recording: Recording, trip: SimulatedTrip) -> Recording:
    """Give a compass and a level in place of the receiver's course."""
    rng = np.random.default_rng(len(trip.image))
    t = np.arange(0.0, trip.truth["t_s"][-1], COMPASS_STEP_S)
    heading = _true("heading_rad", trip, t) + COMPASS_SD_RAD * rng.standard_normal(len(t))
    pitch = _true("pitch_rad", trip, t) + LEVEL_SD_RAD * rng.standard_normal(len(t))
    return _with(recording, {"heading_deg": series(t, np.degrees(heading) % 360.0), "pitch_rad": series(t, pitch)})


def _with(recording: Recording, more: Mapping[str, Series]) -> Recording:
    return Recording({**recording.signals, **more}, recording.started_at_utc_s, recording.texts, recording.warnings)


def _true(column: str, trip: SimulatedTrip, t_s: FloatArray) -> FloatArray:
    return np.interp(t_s, trip.truth["t_s"], trip.truth[column])


MODES: dict[str, Mode] = {
    "all sensors": lambda recording, trip: recording,
    "no GPS": lacking("gps"),
    "no elevation": lacking("dem"),
    "no accelerometer": lacking("acc"),
    "no Vss": lacking("vss"),
    "no Vss, no elevation": lacking("vss", "dem"),
    **{f"accelerometer without {name[1]}": lacking_axis(name) for name in ACCELEROMETER},
    "tunnel, 3 minutes": tunnel,
    "garage, 4 minutes": garage,
    "garage, with gyroscope": lambda recording, trip: with_gyroscope(garage(recording, trip), trip),
    "with gyroscope": with_gyroscope,
    "with compass and level": with_compass,
    "no GPS, with compass and level": lambda recording, trip: with_compass(lacking("gps")(recording, trip), trip),
}
"""Each mode by the name the table gives it."""
WITHOUT_ELEVATION = frozenset(name for name in MODES if "no elevation" in name)
"""Those that get no elevation table."""
