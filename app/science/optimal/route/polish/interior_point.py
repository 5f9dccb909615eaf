"""The least fuel over the energies at a mesh's nodes, with every limit kept by a barrier that shrinks.

A primal-dual interior point method: the barrier stands before slacks, s · n = τ holds for each limit and its multiplier
n, and each Newton step is one banded factorisation. The time limit is one limit more, and its multiplier is the price
of a second, μ. Where the banded matrix isn't positive definite, curvatures below zero are taken out point by point.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.problem import Route
from app.science.optimal.route.polish.basis import DEGREE
from app.science.optimal.route.polish.burning import Powertrain
from app.science.optimal.route.polish.iterate import Look, Point
from app.science.optimal.route.polish.lagrangian import drag_per_energy, fuel_per_metre, motion_on, time_per_metre
from app.science.optimal.route.polish.mesh import Mesh
from app.science.optimal.route.polish.move import Change, Move
from app.science.optimal.route.polish.newton import Assembly, Quadratic, clipped, reduced, solved
from app.science.optimal.route.polish.rooms import edge_bounds_j, holds_back, rolls_freely, rooms_at
from app.science.progress import Progress

FIRST, LAST = 1e-2, 1e-11
"""Barriers, of what a metre costs."""
ROUNDS = 120
STATIONARY, RESTORED = 2e-9, 2e-9
SETTLED = 1e3, 10.0
STIFF = 1e7
PUSHED = 0.1
PATIENCE, ROUNDED, STUCK = 4, 1e-7, 12
"""Rounds without progress at the last barrier, residual below which rounding is all that is left, and rounds above."""
NEAR = 0.9
ATTEMPTS = ((False, 0.0), (True, 0.0), (True, 1e-9), (True, 1e-6), (True, 1e-3))
"""At a factor: whether curvatures are made convex first, and by how much the diagonal grows."""
RUNAWAY = 1e12
"""A multiplier that large grows for ever."""


@dataclass(frozen=True, slots=True)
class Found:
    """Where the iteration ended.

    Attributes
    ----------
    mesh : Mesh
    point : Point
    look : Look
    stationary : float
        Largest derivative of the Lagrangian by a node's energy, J/J.
    missed : float
        Largest limit that is missed, of its size.
    barrier : float
        Product of slack and multiplier at each limit, J/m.
    rounds : int
    """

    mesh: Mesh
    point: Point
    look: Look
    stationary: float
    missed: float
    barrier: float
    rounds: int

    @property
    def settled(self) -> bool:
        """Whether the drive is stationary and keeps its limits."""
        return self.stationary <= SETTLED[0] * STATIONARY and self.missed <= SETTLED[1] * RESTORED


class InteriorPoint:
    """The method on one mesh.

    Parameters
    ----------
    problem : Route
    power : Powertrain
    mesh : Mesh
    rounds : int
        At most.
    """

    def __init__(self, problem: Route, power: Powertrain, mesh: Mesh, rounds: int = ROUNDS) -> None:
        self.rounds = rounds
        self.problem, self.power, self.mesh = problem, power, mesh
        self.mass_kg = problem.load.accelerated_mass_kg
        self.assembly = Assembly(mesh, drag_per_energy(problem.load))
        self.road_m = float(mesh.edges_m[-1] - mesh.edges_m[0])
        self.free = rolls_freely(mesh, power, problem.brake_max_n)
        self.brakes = holds_back(power, problem.brake_max_n)
        self.limited = problem.max_time_s is not None
        self.edge_bounds = edge_bounds_j(mesh)
        self.edge_weight = self.road_m / len(mesh.gear)
        self.inner = np.zeros((2, len(mesh.gear) + 1), dtype=np.bool_)
        self.inner[:, 1:-1] = True

    def look(self, nodes_j: FloatArray, brake_n: FloatArray) -> Look:
        """Return what a drive burns, takes and leaves room for."""
        motion = motion_on(self.mesh, self.problem.load, nodes_j)
        burned = self.power.burned(motion.speed_mps, motion.force_n + brake_n, self.mesh.ratio_radpm[:, None])
        fuel = fuel_per_metre(burned, motion.speed_mps, self.mass_kg)
        time = time_per_metre(motion.speed_mps, self.mass_kg)
        rooms = rooms_at(self.mesh, self.power, motion, brake_n, self.problem.brake_max_n, self.mass_kg)
        low, high = self.edge_bounds
        edges, weight = nodes_j[::DEGREE], self.assembly.weight
        return Look(
            motion, fuel, time, rooms, np.array([edges - low, high - edges]), float((weight * fuel.value).sum()),
            float((weight * time.value).sum()),
        )  # fmt: skip

    def late_s(self, point: Point, look: Look) -> float:
        """Return by how much the slack of time is too small."""
        return (self.problem.max_time_s or 0.0) - look.time_s - point.time_slack_s

    def missed(self, point: Point, look: Look) -> float:
        """Return how far limits and equations are missed, over the road; time aside."""
        weight, rooms = self.assembly.weight, look.rooms
        total = float((weight * np.where(rooms.counts, np.abs(rooms.room - point.slack), 0.0)).sum())
        total += float((weight * np.abs(look.motion.force_n))[self.free].sum())
        return total + self.edge_weight * float((self.inner * np.abs(look.edge_room - point.edge_slack)).sum())

    def spring(self, look: Look) -> float:
        """Return the stiffness that holds a car that rolls freely to its equation, J/(m N²)."""
        return STIFF * look.fuel_j / self.road_m / self.mass_kg**2

    def started(self, nodes_j: FloatArray, price_w: float, barrier: float) -> Point:
        """Return a point at given energies, its slacks pushed inside by more the higher the barrier is."""
        most: FloatArray | float = self.problem.brake_max_n
        pushed = PUSHED * barrier**0.5
        motion = motion_on(self.mesh, self.problem.load, nodes_j)
        brake = np.zeros(self.assembly.weight.shape)
        if self.brakes:
            least = self.power.lowest(motion.speed_mps, self.mesh.ratio_radpm[:, None]).force_n
            back = self.power.retards(motion.speed_mps)
            most = most + (np.min([one.force_n for one in back], axis=0) if back else 0.0)
            brake = np.clip(least - motion.force_n, pushed * most, (1.0 - pushed) * most)
        look = self.look(nodes_j, brake)
        slack = np.maximum(look.rooms.room, pushed * _size(look.rooms.room, (1, 2)))
        edge_slack = np.maximum(look.edge_room, pushed * _size(look.edge_room, (1,)))
        tau = barrier * look.fuel_j / self.road_m
        time_slack, price = 1.0, 0.0
        if self.problem.max_time_s is not None:
            time_slack = max(self.problem.max_time_s - look.time_s, pushed * self.problem.max_time_s)
            price = max(price_w, tau * self.road_m / time_slack)
        return Point(
            nodes_j, brake, slack, tau / slack, edge_slack, tau / edge_slack, np.zeros(brake.shape), time_slack, price
        )

    def run(self, start: Point, progress: Progress, first: float = FIRST) -> Found:
        """Iterate from a point; ``first`` is the first barrier, of what a metre costs."""
        # where no drive fulfils the problem multipliers grow without bounds, and the run doesn't settle
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self._run(start, progress, first)

    def _run(self, start: Point, progress: Progress, first: float) -> Found:
        point, look = start, self.look(start.nodes_j, start.brake_n)
        metre = look.fuel_j / self.road_m
        barrier, penalty = first, 0.0
        rounds, idle, least = 0, 0, np.inf
        while True:
            off, missed = self.residuals(point, look)
            while barrier > LAST and off <= max(barrier, STATIONARY) and self.centred(point, look, barrier * metre):
                barrier = max(min(0.2 * barrier, barrier**1.5), LAST)
            done = barrier <= LAST and off <= STATIONARY and missed <= RESTORED
            done = done and self.centred(point, look, barrier * metre)
            idle = idle + 1 if barrier <= LAST and off >= 0.5 * least else 0
            least = min(off, least)
            done = done or idle >= (PATIENCE if off <= ROUNDED else STUCK)
            lost = not float(point.multiplier.max()) < RUNAWAY  # limits that contradict each other on this mesh
            moved = None if done or lost or rounds >= self.rounds else self.step(point, look, barrier * metre, penalty)
            if moved is None:
                return Found(self.mesh, point, look, off, missed, barrier * metre, rounds)
            rounds += 1
            progress(rounds / self.rounds)
            point, look, penalty = moved

    def residuals(self, point: Point, look: Look) -> tuple[float, float]:
        """Return the largest derivative of the Lagrangian, and the largest limit missed, of its size."""
        rooms = look.rooms
        n = np.where(rooms.counts, point.multiplier, 0.0)
        by_e = look.fuel.by_e + point.price_w * look.time.by_e - (n * rooms.by_e).sum(axis=0)
        gradient = self.assembly.gradient(by_e, look.fuel.by_f - (n * rooms.by_f).sum(axis=0) + point.rolling)
        gradient[::DEGREE] -= self.edge_weight * (point.edge_multiplier[0] - point.edge_multiplier[1])
        by_b = look.fuel.by_f - (n * rooms.by_b).sum(axis=0) if self.brakes else np.zeros(1)
        off = np.where(rooms.counts, np.abs(rooms.room - point.slack), 0.0) / _size(rooms.room, (1, 2))
        edges = self.inner * np.abs(look.edge_room - point.edge_slack) / _size(look.edge_room, (1,))
        missed = max(float(off.max()), float(edges.max()))
        if self.free.any():
            missed = max(missed, float(np.abs(look.motion.force_n[self.free]).max()) / self.mass_kg)
        if self.problem.max_time_s is not None:
            missed = max(missed, abs(self.late_s(point, look)) / self.problem.max_time_s)
        return max(float(np.abs(gradient[1:-1]).max()), float(np.abs(by_b).max())), missed

    def centred(self, point: Point, look: Look, tau: float) -> bool:
        """Tell whether slacks times multipliers are near the barrier's weight."""
        products = np.where(look.rooms.counts, point.slack * point.multiplier, tau)
        edges = np.where(self.inner, point.edge_slack * point.edge_multiplier, tau)
        if max(float(np.abs(products - tau).max()), float(np.abs(edges - tau).max())) > NEAR * tau:
            return False
        whole = tau * self.road_m
        return not self.limited or abs(point.time_slack_s * point.price_w - whole) <= NEAR * whole

    def model(self, point: Point, look: Look, tau: float, *, convex: bool) -> tuple[Quadratic, FloatArray]:
        """Return the Newton system's quadratic model at the points, and what edges add to gradient and Hessian."""
        rooms, fuel, time, mu = look.rooms, look.fuel, look.time, point.price_w
        n = np.where(rooms.counts, point.multiplier, 0.0)
        stiff = n / point.slack
        pull = np.where(rooms.counts, tau / point.slack, 0.0) - stiff * (rooms.room - point.slack)
        ee, ef, ff = fuel.by_ee + mu * time.by_ee - (n * rooms.by_ee).sum(axis=0), fuel.by_ef, fuel.by_ff
        if convex:
            ee, ef, ff = clipped(ee, ef, ff)
        springs = np.where(self.free, self.spring(look), 0.0)[:, None]
        by_b = fuel.by_f - (rooms.by_b * pull).sum(axis=0)
        quadratic = Quadratic(
            e=fuel.by_e + mu * time.by_e - (rooms.by_e * pull).sum(axis=0),
            f=fuel.by_f - (rooms.by_f * pull).sum(axis=0) + point.rolling + springs * look.motion.force_n,
            b=by_b,
            ee=ee + (rooms.by_e**2 * stiff).sum(axis=0),
            ef=ef + (rooms.by_e * rooms.by_f * stiff).sum(axis=0),
            ff=ff + (rooms.by_f**2 * stiff).sum(axis=0) + springs,
            eb=ef + (rooms.by_e * rooms.by_b * stiff).sum(axis=0),
            fb=ff + (rooms.by_f * rooms.by_b * stiff).sum(axis=0),
            bb=ff + (rooms.by_b**2 * stiff).sum(axis=0),
        )
        if not self.brakes:
            none = np.zeros(ee.shape)
            quadratic = replace(quadratic, b=none, eb=none, fb=none, bb=none + 1.0)
        sigma = np.where(self.inner, point.edge_multiplier / point.edge_slack, 0.0)
        edge_pull = np.where(self.inner, tau / point.edge_slack, 0.0) - sigma * (look.edge_room - point.edge_slack)
        return quadratic, self.edge_weight * np.array([edge_pull[1] - edge_pull[0], sigma[0] + sigma[1]])

    def step(self, point: Point, look: Look, tau: float, penalty: float) -> tuple[Point, Look, float] | None:
        """Return the next point, its look and the weight of missed limits; None where no step is found."""
        asm, slack_s, price = self.assembly, point.time_slack_s, point.price_w
        border = asm.gradient(look.time.by_e, look.time.by_f)
        stiff = price / slack_s if self.limited else 0.0
        pull = tau * self.road_m / slack_s - price - stiff * self.late_s(point, look) if self.limited else 0.0
        for convex, more in ATTEMPTS:
            model, edges = self.model(point, look, tau, convex=convex)
            if (model.bb <= 0.0).any():
                continue
            e, f, ee, ef, ff = reduced(model)
            gradient = asm.gradient(e, f)
            gradient[::DEGREE] += edges[0]
            band = asm.banded(ee, ef, ff, edges[1])
            band[DEGREE] *= 1.0 + more
            nodes = solved(band, -gradient - pull * border, border, stiff)
            if nodes is not None:
                energy, force = asm.at_points(nodes)
                brake = -(model.b + model.eb * energy + model.fb * force) / model.bb
                return Move(self, point, look, Change(nodes, energy, force, brake), tau).taken(penalty)
        return None


def _size(room: FloatArray, axes: tuple[int, ...]) -> FloatArray:
    """Return how large rooms are, for each limit."""
    return np.asarray(np.abs(room).mean(axis=axes, keepdims=True) + 1e-9)
