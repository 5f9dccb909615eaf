"""The road of the virtual car: bends over hilly ground, speed limits and places to stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.arrays import FloatArray, IntArray

RouteName = Literal["mixed", "motorway", "town", "full-load", "tunnel"]
ROAD_STEP_M = 0.5
_GRADE_SD = 0.023
_HOME_RADIUS_M = 9000.0


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
        Which way (stretch of one kind of road) each sample belongs to.
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


@dataclass(frozen=True, slots=True)
class _Kind:
    limits_kmph: tuple[float, ...]
    limit_every_m: tuple[float, float]
    straight_m: tuple[float, float]
    radius_m: tuple[float, float]
    turn_rad: tuple[float, float]
    length_m: tuple[float, float]
    stop_every_m: tuple[float, float] | None
    wait_s: tuple[float, float] = (4.0, 30.0)


_KINDS = {
    "town": _Kind(
        (30, 50, 50, 60), (300, 900), (60, 260), (14, 120), (0.3, 1.6), (1500, 4000), (250, 800), (4.0, 30.0)
    ),
    "country": _Kind((60, 70, 80, 90, 100), (500, 1800), (40, 400), (70, 600), (0.15, 1.3), (4000, 9000), (2500, 6000)),
    "motorway": _Kind((100, 110, 120, 130), (1500, 5000), (300, 1500), (800, 3000), (0.1, 0.6), (6000, 12000), None),
    "sprint": _Kind((50, 70, 90, 110, 130), (400, 1200), (300, 900), (600, 2500), (0.1, 0.6), (6000, 12000), None),
}
_SEQUENCES: dict[str, tuple[str, ...]] = {
    "mixed": ("town", "country", "motorway", "country"),
    "motorway": ("motorway",),
    "town": ("town",),
    "full-load": ("sprint",),
    "tunnel": ("country", "motorway"),
}


def build_road(route: RouteName, duration_s: float, rng: np.random.Generator) -> Road:
    """Lay out a road long enough for the given driving time.

    Bends are straights, transition curves and arcs that keep turning back towards the start; the ground is a sum of
    waves of 260 m to 9 km in random directions, so that a road that crosses itself meets itself at one altitude.

    Parameters
    ----------
    route : str
    duration_s : float
        Driving time the road must last for, s.
    rng : numpy.random.Generator
    """
    plan = _Plan(rng)
    sequence = _SEQUENCES[route]
    turn = int(rng.integers(len(sequence))) if route == "mixed" else 0
    while plan.driving_s < duration_s + 120.0:
        plan.add_section(_KINDS[sequence[turn % len(sequence)]])
        turn += 1
    return _over_ground(plan, rng)


class _Plan:
    """The road seen from above while it is being laid: knots of curvature, limits, stops."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.at_m = 0.0
        self.north = self.east = 0.0
        self.heading = 0.0
        self.knots: list[tuple[float, float]] = [(0.0, 0.0)]
        self.limits: list[tuple[float, float]] = []
        self.stops: list[tuple[float, float]] = []
        self.ways: list[float] = []
        self.driving_s = 0.0

    def add_section(self, kind: _Kind) -> None:
        """Append one stretch of a kind of road."""
        begin = self.at_m
        end = begin + self._draw(kind.length_m)
        self.ways.append(begin)
        while self.at_m < end:
            self._straight(self._draw(kind.straight_m))
            self._bend(kind)
        at = begin
        while at < self.at_m:
            limit = float(self.rng.choice(kind.limits_kmph)) / 3.6
            length = min(self._draw(kind.limit_every_m), self.at_m - at)
            self.limits.append((at, limit))
            self.driving_s += length / limit
            at += length
        if kind.stop_every_m is not None:
            at = begin + self._draw(kind.stop_every_m)
            while at < self.at_m - 50.0:
                self.stops.append((at, self._draw(kind.wait_s)))
                at += self._draw(kind.stop_every_m)

    def _draw(self, bounds: tuple[float, float]) -> float:
        return float(self.rng.uniform(*bounds))

    def _straight(self, length: float) -> None:
        self._advance(length, 0.0)
        self.knots.append((self.at_m, 0.0))

    def _bend(self, kind: _Kind) -> None:
        radius = float(np.exp(self.rng.uniform(np.log(kind.radius_m[0]), np.log(kind.radius_m[1]))))
        turn = self._draw(kind.turn_rad)
        curvature = self._side() / radius
        transition = min(0.5 * radius * turn, max(12.0, radius**0.6))
        arc = max(radius * turn - transition, 1.0)
        for length, mean, end in (
            (transition, 0.5 * curvature, curvature),
            (arc, curvature, curvature),
            (transition, 0.5 * curvature, 0.0),
        ):
            self._advance(length, mean)
            self.knots.append((self.at_m, end))

    def _side(self) -> float:
        away = np.hypot(self.north, self.east)
        home = np.sin(np.arctan2(-self.east, -self.north) - self.heading)
        if self.rng.uniform() < min(0.85, away / _HOME_RADIUS_M):
            return 1.0 if home > 0 else -1.0
        return 1.0 if self.rng.uniform() < 0.5 else -1.0

    def _advance(self, length: float, curvature: float) -> None:
        middle = self.heading + 0.5 * curvature * length
        self.north += length * float(np.cos(middle))
        self.east += length * float(np.sin(middle))
        self.heading += curvature * length
        self.at_m += length


def _over_ground(plan: _Plan, rng: np.random.Generator) -> Road:
    start_heading = rng.uniform(0, 2 * np.pi)
    flat = np.arange(0.0, plan.at_m, ROAD_STEP_M)
    knots = np.array(plan.knots)
    curvature = np.interp(flat, knots[:, 0], knots[:, 1])
    heading = start_heading + _integral(curvature, ROAD_STEP_M)
    north = _integral(np.cos(heading), ROAD_STEP_M)
    east = _integral(np.sin(heading), ROAD_STEP_M)
    slope = np.zeros_like(flat)
    wavelengths = np.geomspace(260.0, 9000.0, 18)
    steepness = 2.0 * _GRADE_SD / np.sqrt(len(wavelengths))
    for wavelength in wavelengths:
        direction, phase = rng.uniform(0, 2 * np.pi, 2)
        wave = 2 * np.pi / wavelength
        along = north * np.cos(direction) + east * np.sin(direction)
        slope += steepness * np.cos(wave * along + phase) * np.cos(heading - direction)
    secant = np.sqrt(1.0 + slope**2)
    true_length = _integral(secant, ROAD_STEP_M)
    distance = np.arange(0.0, true_length[-1], ROAD_STEP_M)
    pitch = np.interp(distance, true_length, np.arctan(slope))
    heading = np.interp(distance, true_length, heading)
    cosine = np.cos(pitch)
    at_flat = np.interp(distance, true_length, flat)
    curvature_h = np.interp(at_flat, flat, curvature) * cosine
    limits = np.array(plan.limits)
    limit = limits[np.searchsorted(limits[:, 0], at_flat, side="right") - 1, 1]
    limit = np.minimum(limit, np.sqrt(2.6 / np.maximum(np.abs(curvature_h), 1e-5)))
    stops = np.array(plan.stops).reshape(-1, 2)
    return Road(
        distance_m=distance,
        heading_rad=heading,
        pitch_rad=pitch,
        curvature_h_radpm=curvature_h,
        curvature_v_radpm=np.gradient(pitch, ROAD_STEP_M),
        north_m=_integral(np.cos(heading) * cosine, ROAD_STEP_M),
        east_m=_integral(np.sin(heading) * cosine, ROAD_STEP_M),
        alt_m=320.0 + _integral(np.sin(pitch), ROAD_STEP_M),
        limit_mps=_slow_down_ahead(limit, 1.2),
        way=np.searchsorted(np.array(plan.ways), at_flat, side="right") - 1,
        stop_m=np.interp(stops[:, 0], flat, true_length),
        stop_wait_s=stops[:, 1],
    )


def _integral(values: FloatArray, step: float) -> FloatArray:
    """Trapezoidal running integral from zero, same shape."""
    result = np.zeros_like(values)
    np.cumsum(0.5 * step * (values[1:] + values[:-1]), out=result[1:])
    return result


def _slow_down_ahead(limit_mps: FloatArray, braking_mps2: float) -> FloatArray:
    """Lower a limit ahead of slower stretches so that braking at the given rate suffices."""
    n = len(limit_mps)
    rise = 2.0 * braking_mps2 * ROAD_STEP_M * np.arange(n)
    squared = np.minimum.accumulate((limit_mps**2 + rise)[::-1])[::-1] - rise
    return np.asarray(np.sqrt(squared))
