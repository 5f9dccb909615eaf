"""How constant H is along smooth arcs, with both costates integrated by their own equations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, IntArray
from app.science.optimal.problem import Route
from app.science.optimal.route.polish.basis import BASIS, DEGREE, PLAIN
from app.science.optimal.route.polish.interior_point import Found
from app.science.optimal.route.polish.kinks import JUMP_M, active, codes
from app.science.optimal.route.polish.lagrangian import drag_per_energy
from app.science.optimal.route.polish.tracing import Traced


def smooth_elements(found: Found) -> BoolArray:
    """Return the elements in which one set of limits holds, shape (n,); those at standstill are none."""
    code = codes(found)
    plain = (found.mesh.kind == PLAIN) & (found.mesh.length_m > 3.0 * JUMP_M)
    return np.asarray((code == code[:, :1]).all(axis=1) & plain)


def touches(found: Found) -> BoolArray:
    """Return the inner edges at which the drive touches a limit of its speed, so that its costate jumps, (n − 1,)."""
    slack, n = found.point.edge_slack[:, 1:-1], found.point.edge_multiplier[:, 1:-1]
    size = np.abs(found.look.edge_room).mean() + 1e-9
    metre = found.look.fuel_j / float(found.mesh.length_m.sum())
    return np.asarray((slack * metre / size < n * size).any(axis=0))


def arcs_of(found: Found) -> list[IntArray]:
    """Return the elements of each arc in which gear and limits that hold stay the same."""
    code, gear, smooth = codes(found)[:, 0], found.mesh.gear, smooth_elements(found)
    new = (np.diff(code) != 0) | (np.diff(gear) != 0) | ~smooth[1:] | ~smooth[:-1] | touches(found)
    return [arc for arc in np.split(np.arange(len(gear)), np.flatnonzero(new) + 1) if smooth[arc].all()]


@dataclass(frozen=True, slots=True)
class Drift:
    """Of one arc: its elements and the largest change of H within it, W."""

    elements: IntArray
    watts: float


def drifts_of(problem: Route, found: Found, drive: Traced) -> list[Drift]:
    """Return the largest change of H within each arc.

    Over distance the costate p of kinetic energy obeys p′ = (2 r₂/M_a) p + ∂L/∂E and what limits add that move with the
    speed; λ_x changes by p times the change of slope, and H − μ = v (λ_x − (P + μ)/v + p E′). Both have
    their values from stationarity in the middle of an arc. Arcs along a speed limit have p from stationarity alone.
    """
    mesh, look, load = found.mesh, found.look, problem.load
    rooms = look.rooms
    holds = active(found)
    rate = np.full(look.fuel.value.shape, drag_per_energy(load))
    gain = look.fuel.by_e + found.point.price_w * look.time.by_e
    of_pull = holds & (rooms.by_f != 0.0)
    rate += (of_pull * rooms.by_f * rooms.by_e).sum(axis=0)
    gain = gain - (of_pull * rooms.by_f * rooms.by_e).sum(axis=0) * look.fuel.by_f
    of_brakes = holds & (rooms.by_f == 0.0) & (rooms.by_b != 0.0)
    rate -= (of_brakes * rooms.by_b * rooms.by_e).sum(axis=0)
    on_limit = np.asarray(holds[:2].any(axis=2).any(axis=0))
    upto = BASIS.upto[mesh.kind] * mesh.length_m[:, None, None]
    inner = upto[:, :DEGREE, :]
    solve = np.eye(DEGREE) - inner * rate[:, None, :]
    from_begin = np.linalg.solve(solve, np.ones((len(rate), DEGREE, 1)))[..., 0]
    from_gain = np.linalg.solve(solve, inner @ gain[..., None])[..., 0]
    drifts = []
    for arc in arcs_of(found):
        if on_limit[arc].any():
            continue
        middle = len(arc) // 2
        p0, off, price = 0.0, [], 0.0
        share, rest = 1.0, 0.0
        for e in arc[:middle].tolist():
            keep = 1.0 + float(upto[e, DEGREE] @ (rate[e] * from_begin[e]))
            rest = keep * rest + float(upto[e, DEGREE] @ (rate[e] * from_gain[e] + gain[e]))
            share *= keep
        e = int(arc[middle])
        p0 = ((drive.costate[e, 1] - from_gain[e, 0]) / from_begin[e, 0] - rest) / share
        for k, e in enumerate(arc.tolist()):
            p = from_begin[e] * p0 + from_gain[e]
            if k:
                price += p0 * (mesh.slope_n[e] - mesh.slope_n[e - 1])
            energy, v = look.motion.energy_j[e], look.motion.speed_mps[e]
            rise = look.motion.force_n[e] - drag_per_energy(load) * energy - mesh.slope_n[e]
            metre = look.fuel.value[e] + found.point.price_w / v - p * rise
            if not k:
                price = float(metre[0])
            off.append(v * (price - metre))
            p0 = p0 + float(upto[e, DEGREE] @ (rate[e] * p + gain[e]))
        h = np.concatenate(off)
        drifts.append(Drift(arc, float(np.abs(h - h.mean()).max())))
    return drifts
