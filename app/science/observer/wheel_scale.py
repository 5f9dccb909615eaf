"""How far the positions move for each metre that the wheels' ticks tell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.logger.recording import Recording
from app.science.roads.projection import LocalPlane

SPAN_S = 60.0
SHORTEST_WAY_M = 200.0
FIX_WITHIN_S = 1.5
FEWEST_SPANS = 5
SLOWEST_COURSE_MPS = 2.0


@dataclass(frozen=True, slots=True)
class WheelScale:
    """Metres by the fixes for each metre by the wheels, with its standard deviation."""

    scale: float
    sd: float


def wheel_scale(recording: Recording, columns: Mapping[str, FloatArray], plane: LocalPlane | None) -> WheelScale | None:
    """Compare the way between fixes a minute apart with the wheels' way along the receiver's course.

    Parameters
    ----------
    recording : Recording
    columns : mapping of str to array
        Of the observation: ``t_s``, ``speed_mps``, ``heading_rad``, ``pitch_rad``. Speed follows the ticks closely. The
        heading weaves where the scale is wrong, so it stands in only where the receiver tells no course.
    plane : LocalPlane or None

    Returns
    -------
    WheelScale or None
        None without ticks, without fixes, or where there is too little of both.
    """
    if plane is None or "vss_tick" not in recording:
        return None
    fixes = recording["lat_deg"]
    nodes = columns["t_s"]
    t = np.arange(fixes.t_s[0], fixes.t_s[-1], SPAN_S)
    at = np.clip(np.searchsorted(fixes.t_s, t), 0, len(fixes) - 1)
    fixed = np.abs(fixes.t_s[at] - t) < FIX_WITHIN_S
    t = fixes.t_s[at]
    place = plane.forward(fixes.value[at], recording["lon_deg"].value[at])
    level = columns["speed_mps"] * np.cos(columns["pitch_rad"])
    north, east = (np.diff(np.interp(t, nodes, _integral(level * part, nodes))) for part in _course(recording, columns))
    way = np.hypot(north, east)
    used = fixed[1:] & fixed[:-1] & (way > SHORTEST_WAY_M) & np.isfinite(way)
    if np.count_nonzero(used) < FEWEST_SPANS:
        return None
    way = way[used]
    along = (np.diff(place.north_m) * north + np.diff(place.east_m) * east)[used] / way
    scale = float(np.sum(along * way) / np.sum(way**2))
    scatter = np.sqrt(np.sum((along - scale * way) ** 2) / (len(way) - 1))
    return WheelScale(scale, float(scatter / np.sqrt(np.sum(way**2))))


def _course(recording: Recording, columns: Mapping[str, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return north and east part of the direction of travel at the nodes."""
    course = recording.get("heading_deg")
    if course is not None:
        moving = np.interp(course.t_s, columns["t_s"], columns["speed_mps"]) > SLOWEST_COURSE_MPS
        if moving.any():
            t, heading = course.t_s[moving], np.unwrap(np.radians(course.value[moving]))
            along = np.interp(columns["t_s"], t, heading)
            return np.cos(along), np.sin(along)
    return np.cos(columns["heading_rad"]), np.sin(columns["heading_rad"])


def _integral(rate: FloatArray, t_s: FloatArray) -> FloatArray:
    return np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t_s))))
