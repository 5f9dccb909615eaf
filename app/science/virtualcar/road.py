"""The road of the virtual car in space: bends laid over hilly ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.virtualcar.alignment import Alignment, lay_out
from app.science.virtualcar.specification import RouteName

ROAD_STEP_M = 0.5
_GRADE_SD = 0.023
_WAVES = 18
_LATERAL_MPS2 = 2.6
_BRAKING_MPS2 = 1.2
_START_ALT_M = 320.0


@dataclass(frozen=True, slots=True)
class Road:
    """A road, sampled every `ROAD_STEP_M` along its own length; every array of shape (n,) unless stated.

    Attributes
    ----------
    distance_m : array
        Along the road, in space.
    heading_rad, pitch_rad : array
        North to east, not wrapped; nose up.
    curvature_h_radpm, curvature_v_radpm : array
        dψ/ds and dθ/ds.
    north_m, east_m, alt_m : array
        From the start; altitude above sea level.
    limit_mps : array
        Speed that signs and bends allow, already lowered ahead of slower stretches.
    way : integer array
        Which way (section of one kind of road) each sample belongs to.
    stop_m, stop_wait_s : array, shape (k,)
        Where the car must stop and for how long.
    """

    distance_m: FloatArray
    heading_rad: FloatArray
    pitch_rad: FloatArray
    curvature_h_radpm: FloatArray
    curvature_v_radpm: FloatArray
    north_m: FloatArray
    east_m: FloatArray
    alt_m: FloatArray
    limit_mps: FloatArray
    way: IntArray
    stop_m: FloatArray
    stop_wait_s: FloatArray

    def at(self, distance_m: FloatArray, values: FloatArray) -> FloatArray:
        """Values of one of the road's arrays at distances along it, linear between the samples."""
        return np.asarray(np.interp(distance_m, self.distance_m, values))


def build_road(route: RouteName, duration_s: float, rng: np.random.Generator) -> Road:
    """Build a road long enough for the given driving time.

    The ground is a sum of waves of 260 m to 9 km in random directions, with a standard deviation of the grade of 2.3 %.
    A road that crosses itself therefore meets itself at one altitude.

    Parameters
    ----------
    route : str
    duration_s : float
        Driving time the road must last for, s.
    rng : numpy.random.Generator
    """
    alignment = lay_out(route, duration_s, rng)
    flat = np.arange(0.0, alignment.length_m, ROAD_STEP_M)
    knots = np.array(alignment.knots)
    curvature = np.interp(flat, knots[:, 0], knots[:, 1])
    heading = rng.uniform(0.0, 2.0 * np.pi) + _integral(curvature)
    grade = _grade(_integral(np.cos(heading)), _integral(np.sin(heading)), heading, rng)
    along = _integral(np.sqrt(1.0 + grade**2))

    distance = np.arange(0.0, along[-1], ROAD_STEP_M)
    on_map = np.interp(distance, along, flat)
    heading = np.interp(distance, along, heading)
    pitch = np.interp(distance, along, np.arctan(grade))
    curvature = np.interp(on_map, flat, curvature) * np.cos(pitch)
    stops = np.array(alignment.stops).reshape(-1, 2)
    return Road(
        distance_m=distance,
        heading_rad=heading,
        pitch_rad=pitch,
        curvature_h_radpm=curvature,
        curvature_v_radpm=np.gradient(pitch, ROAD_STEP_M),
        north_m=_integral(np.cos(heading) * np.cos(pitch)),
        east_m=_integral(np.sin(heading) * np.cos(pitch)),
        alt_m=_START_ALT_M + _integral(np.sin(pitch)),
        limit_mps=_limits(alignment, on_map, curvature),
        way=np.searchsorted(np.array(alignment.ways), on_map, side="right") - 1,
        stop_m=np.interp(stops[:, 0], flat, along),
        stop_wait_s=stops[:, 1].copy(),
    )


def _grade(north: FloatArray, east: FloatArray, heading: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Slope of the ground in the direction of travel, rise over run."""
    grade = np.zeros_like(north)
    steepness = 2.0 * _GRADE_SD / np.sqrt(_WAVES)
    for wavelength in np.geomspace(260.0, 9000.0, _WAVES):
        direction, phase = rng.uniform(0.0, 2.0 * np.pi, 2)
        along = north * np.cos(direction) + east * np.sin(direction)
        grade += steepness * np.cos(2.0 * np.pi / wavelength * along + phase) * np.cos(heading - direction)
    return grade


def _limits(alignment: Alignment, on_map: FloatArray, curvature: FloatArray) -> FloatArray:
    """Limit of signs and bends, lowered ahead of slower stretches so that gentle braking suffices."""
    begins, limits = np.array(alignment.limits).T
    limit = limits[np.searchsorted(begins, on_map, side="right") - 1]
    squared = np.minimum(limit**2, _LATERAL_MPS2 / np.maximum(np.abs(curvature), 1e-6))
    rise = 2.0 * _BRAKING_MPS2 * ROAD_STEP_M * np.arange(len(squared))
    return np.asarray(np.sqrt(np.minimum.accumulate((squared + rise)[::-1])[::-1] - rise))


def _integral(values: FloatArray) -> FloatArray:
    """Trapezoidal running integral over the road from zero, same shape."""
    result = np.zeros_like(values)
    np.cumsum(0.5 * ROAD_STEP_M * (values[1:] + values[:-1]), out=result[1:])
    return result
