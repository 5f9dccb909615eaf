"""A polished drive over time: its rows, its costates and what holds at each of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.optimal.answer import Trajectory
from app.science.optimal.problem import PolynomialEngine, Route
from app.science.optimal.route.car import engine_speeds
from app.science.optimal.route.polish.basis import BASIS, DEGREE
from app.science.optimal.route.polish.burning import Powertrain
from app.science.optimal.route.polish.interior_point import Found
from app.science.optimal.route.polish.kinks import JUMP_M
from app.science.optimal.route.polish.lagrangian import drag_per_energy

_FROM_POINTS = np.array(
    [
        [np.prod([(x - b) / (a - b) for b in u if b != a]) for a in u]
        for u in [0.5 * (np.polynomial.legendre.leggauss(DEGREE)[0] + 1.0)]
        for x in (0.0, 1.0)
    ]
)
"""Values at both ends of an element from those at its points, shape (2, points), in the variable of its quadrature."""
SLOWEST_MPS = 1e-6


@dataclass(frozen=True, slots=True)
class Traced:
    """A drive by elements: at each one's begin, its points and its end, each array of shape (n, points + 2).

    Attributes
    ----------
    t_s, distance_m, energy_j, speed_mps : array
    pull_n, hold_n : array
        Of the engine at the wheels, and of what holds the car back.
    fuel_power_w : array
    costate : array
        Of the kinetic energy over distance: what a joule of it saves, J/J.
    price_jpm : array
        (P + μ)/v less the costate times E′: what a metre costs, λ_x.
    """

    t_s: FloatArray
    distance_m: FloatArray
    energy_j: FloatArray
    speed_mps: FloatArray
    pull_n: FloatArray
    hold_n: FloatArray
    fuel_power_w: FloatArray
    costate: FloatArray
    price_jpm: FloatArray


def costate_at_points(found: Found) -> FloatArray:
    """Return what a joule of kinetic energy saves, from stationarity and the multipliers of forces, (n, points)."""
    rooms = found.look.rooms
    n = np.where(rooms.counts, found.point.multiplier, 0.0)
    return np.asarray(found.look.fuel.by_f - (n * rooms.by_f).sum(axis=0) + found.point.rolling)


def traced(problem: Route, power: Powertrain, found: Found) -> Traced:
    """Return a drive at the edges and points of its mesh."""
    mesh, look, load = found.mesh, found.look, problem.load
    at = np.column_stack((mesh.edges_m[:-1], mesh.points_m, mesh.edges_m[1:]))
    local = mesh.at_nodes(found.point.nodes_j)
    energy = np.column_stack((local[:, 0], look.motion.energy_j, local[:, -1]))
    speed = np.sqrt(2.0 * np.maximum(energy, 0.0) / load.accelerated_mass_kg)
    force = _with_ends(look.motion.force_n)
    ratio = mesh.ratio_radpm[:, None] + np.zeros(force.shape)
    safe = np.maximum(speed, SLOWEST_MPS)
    low = power.lowest(safe, ratio).force_n
    high = np.min([one.force_n for one in power.highest(safe, ratio)], axis=0)
    if power.brakes_anywhere:
        pull = np.clip(force, low, high)
        force = np.minimum(force, high)
    else:
        pull = force = np.clip(force, low, high)
    fuel = power.burned(safe, np.where(ratio > 0.0, pull, pull * power.brakes_anywhere), ratio).power_w
    upto = BASIS.upto[mesh.kind] * mesh.length_m[:, None, None]
    seconds = (upto @ look.time.value[..., None])[..., 0]
    begin = np.concatenate(([0.0], np.cumsum(seconds[:, -1])[:-1]))
    time = begin[:, None] + np.column_stack((np.zeros(len(begin)), seconds))
    costate = _with_ends(costate_at_points(found))
    slope = force - drag_per_energy(load) * energy - mesh.slope_n[:, None]
    metre = (fuel + found.point.price_w) / safe - costate * slope
    return Traced(time, at, energy, speed, pull, pull - force, fuel, costate, metre)


def _with_ends(at_points: FloatArray) -> FloatArray:
    """Return values at an element's begin, points and end."""
    ends = at_points @ _FROM_POINTS.T
    return np.column_stack((ends[:, 0], at_points, ends[:, 1]))


@dataclass(frozen=True, slots=True)
class Rows:
    """A drive as it is told: the trajectory, and λ_v (J s/m) and λ_x (J/m) along it."""

    trajectory: Trajectory
    speed_costate: FloatArray
    distance_costate: FloatArray


def rows_of(problem: Route, power: Powertrain, found: Found, drive: Traced) -> Rows:
    """Return the rows of a drive; where force or gear jump, a place comes twice."""
    mesh, mass = found.mesh, problem.load.accelerated_mass_kg
    keep = np.ones(drive.t_s.shape, dtype=np.bool_)
    keep[:-1, -1] = _jumps(drive, mesh.gear)
    tiny = mesh.length_m < 3.0 * JUMP_M
    keep[tiny] = False
    keep[tiny, 0] = keep[tiny, -1] = True
    total = drive.pull_n - drive.hold_n
    gear = np.broadcast_to(mesh.gear[:, None], keep.shape)[keep]
    speed, pull = drive.speed_mps[keep], drive.pull_n[keep]
    omega, torque = _engine(problem, np.broadcast_to(mesh.ratio_radpm[:, None], keep.shape)[keep], speed, pull)
    if power.brakes_anywhere:
        back = power.retards(np.maximum(speed, SLOWEST_MPS))
        drags = np.min([one.force_n for one in back], axis=0) if back else 0.0
        brake = np.maximum(drive.hold_n[keep] - drags, 0.0)
    else:
        brake = np.where(gear == 0, np.maximum(-total[keep], 0.0), 0.0)
    trajectory = Trajectory(
        drive.t_s[keep], drive.distance_m[keep], speed, gear, omega, torque, drive.fuel_power_w[keep],
        np.where(brake > FEW_N, brake, 0.0),
    )  # fmt: skip
    return Rows(trajectory, drive.costate[keep] * mass * speed, drive.price_jpm[keep])


FEW_N = 1e-3
SAME_N = 1e-3


def _jumps(drive: Traced, gear: np.ndarray) -> BoolArray:
    """Return at which inner edges gear or force jump, shape (n − 1,)."""
    force = drive.pull_n - drive.hold_n
    step = np.abs(force[1:, 0] - force[:-1, -1])
    return np.asarray((np.diff(gear) != 0) | (step > SAME_N * np.abs(force).max()))


def _engine(
    problem: Route, ratio: FloatArray, speed_mps: FloatArray, pull_n: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return engine speed and torque; NaN where they aren't known."""
    unknown = np.full(speed_mps.shape, np.nan)
    if not isinstance(problem.engine, PolynomialEngine):
        return unknown, unknown
    if problem.transmission.kind == "gears":
        pulls = ratio > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):  # no torque in neutral
            return np.where(pulls, ratio * speed_mps, np.nan), np.where(pulls, pull_n / ratio, np.nan)
    power_w = pull_n * speed_mps
    engaged = power_w > 0.0
    omega = unknown.copy()
    omega[engaged] = engine_speeds(problem.engine, power_w[engaged])
    return omega, np.where(engaged, power_w / omega, np.nan)
