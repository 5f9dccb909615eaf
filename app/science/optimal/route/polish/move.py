"""A Newton step of the interior point method, and how far one may go along it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.route.polish.basis import DEGREE
from app.science.optimal.route.polish.iterate import Look, Point

if TYPE_CHECKING:
    from app.science.optimal.route.polish.interior_point import InteriorPoint

KEEPS = 0.995
MOST_HALVINGS = 12
ENOUGH_DESCENT = 1e-4
PRICED = 10.0
"""How much dearer than its price a second too many is to a step."""
NOISE = 1e-11


@dataclass(frozen=True, slots=True)
class Change:
    """Of energies at nodes, and of energy, force and brakes at the points."""

    nodes_j: FloatArray
    energy_j: FloatArray
    force_n: FloatArray
    brake_n: FloatArray


class Move:
    """A change of the drive with those of its slacks and multipliers.

    Parameters
    ----------
    method : InteriorPoint
    point, look
        Where it starts.
    change : Change
    tau : float
        The barrier's weight for a metre, J/m.
    """

    def __init__(self, method: InteriorPoint, point: Point, look: Look, change: Change, tau: float) -> None:
        self.method, self.point, self.look, self.change = method, point, look, change
        self.tau, self.whole = tau, tau * method.road_m
        rooms = look.rooms
        self.miss = np.where(rooms.counts, rooms.room - point.slack, 0.0)
        moved = rooms.by_e * change.energy_j + rooms.by_f * change.force_n + rooms.by_b * change.brake_n
        self.slack = np.where(rooms.counts, moved + self.miss, 0.0)
        self.multiplier = np.where(
            rooms.counts, (tau - point.multiplier * (point.slack + self.slack)) / point.slack, 0.0
        )
        inner = method.inner
        edge = np.array([1.0, -1.0])[:, None] * change.nodes_j[::DEGREE]
        self.edge_miss = np.where(inner, look.edge_room - point.edge_slack, 0.0)
        self.edge_slack = np.where(inner, edge + self.edge_miss, 0.0)
        self.edge_multiplier = np.where(
            inner, (tau - point.edge_multiplier * (point.edge_slack + self.edge_slack)) / point.edge_slack, 0.0
        )
        self.time_slack, self.price = 0.0, 0.0
        if method.limited:
            by_e, by_f = look.time.by_e * change.energy_j, look.time.by_f * change.force_n
            later = float((method.assembly.weight * (by_e + by_f)).sum())
            self.time_slack = method.late_s(point, look) - later
            self.price = (self.whole - point.price_w * (point.time_slack_s + self.time_slack)) / point.time_slack_s

    def merit(self, point: Point, look: Look, penalty: float) -> float:
        """Return fuel, barrier and missed limits in one number."""
        method, counts = self.method, look.rooms.counts
        weight, edge = method.assembly.weight, method.edge_weight * method.inner
        logs = float((weight * np.where(counts, np.log(point.slack), 0.0)).sum())
        logs += float((edge * np.log(point.edge_slack)).sum())
        total = look.fuel_j - self.tau * logs + penalty * method.missed(point, look)
        if method.limited:
            late = abs(method.late_s(point, look))
            total += -self.whole * float(np.log(point.time_slack_s)) + PRICED * self.point.price_w * late
        return total

    def _merit_slope(self) -> float:
        """Return how the merit changes with a small share of the step, missed limits aside."""
        p, fuel, change, weight = self.point, self.look.fuel, self.change, self.method.assembly.weight
        burned = fuel.by_e * change.energy_j + fuel.by_f * (change.force_n + self.method.brakes * change.brake_n)
        slope = float((weight * burned).sum()) - self.tau * float((weight * self.slack / p.slack).sum())
        slope -= self.tau * self.method.edge_weight * float((self.edge_slack / p.edge_slack).sum())
        if self.method.limited:
            slope -= self.whole * self.time_slack / p.time_slack_s
            slope -= PRICED * p.price_w * abs(self.method.late_s(p, self.look))
        return slope

    def taken(self, penalty: float) -> tuple[Point, Look, float]:
        """Go as far as slacks stay above 0 and the merit falls; return where that is, and what missing costs."""
        p, method = self.point, self.method
        primal = min(
            _far(p.slack, self.slack), _far(p.edge_slack, self.edge_slack), _far(p.time_slack_s, self.time_slack)
        )
        dual = min(_far(p.multiplier, self.multiplier), _far(p.edge_multiplier, self.edge_multiplier))
        if method.limited:
            dual = min(dual, _far(p.price_w, self.price))
        missed, slope = method.missed(p, self.look), self._merit_slope()
        if missed > 0.0 and slope > 0.9 * penalty * missed:
            penalty = 1.2 * slope / missed
        slope -= penalty * missed
        before = self.merit(p, self.look, penalty)
        length = primal
        for _ in range(MOST_HALVINGS):
            point = self._moved(length, dual)
            look = method.look(point.nodes_j, point.brake_n)
            if np.isfinite(look.fuel_j) and self.merit(point, look, penalty) <= (
                before + ENOUGH_DESCENT * length * min(slope, 0.0) + NOISE * abs(before)
            ):
                return point, look, penalty
            length *= 0.5
        point = self._moved(length, dual)
        return point, method.look(point.nodes_j, point.brake_n), penalty

    def _moved(self, primal: float, dual: float) -> Point:
        p, method = self.point, self.method
        rolled = np.where(
            method.free[:, None], method.spring(self.look) * (self.look.motion.force_n + self.change.force_n), 0.0
        )
        return Point(
            p.nodes_j + primal * self.change.nodes_j,
            p.brake_n + primal * self.change.brake_n,
            p.slack + primal * self.slack,
            p.multiplier + dual * self.multiplier,
            p.edge_slack + primal * self.edge_slack,
            p.edge_multiplier + dual * self.edge_multiplier,
            p.rolling + primal * rolled,
            p.time_slack_s + primal * self.time_slack,
            p.price_w + dual * self.price,
        )


def _far(value: FloatArray | float, change: FloatArray | float) -> float:
    """Return the largest share of a change, at most 1, that keeps values above 0."""
    ratio = np.asarray(-change) / np.asarray(value)
    return float(min(1.0, KEEPS / max(float(ratio.max()), 1e-300)))
