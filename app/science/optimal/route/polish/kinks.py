"""Where a drive changes from one limit to another: elements end there, so that polynomials stay smooth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.problem import RADPS_PER_RPM, Route
from app.science.optimal.route.polish.basis import BASIS, DEGREE
from app.science.optimal.route.polish.interior_point import Found
from app.science.optimal.route.polish.mesh import Mesh, bends_of, mesh_of

AT_ONCE = 4
"""Points of an arc from which its end is foreseen."""
BESIDE = 0.02
"""Of an element: a soft edge that near to a kink gives way."""
TINY_M = 1e-6
JUMP_M = 1e-3
NEARLY_FULL = 0.98


def active(found: Found) -> BoolArray:
    """Return which limits hold at the points, shape (m, n, points): there the multiplier outweighs the slack."""
    rooms, point = found.look.rooms, found.point
    size = np.abs(rooms.room).mean(axis=(1, 2), keepdims=True) + 1e-9
    metre = found.look.fuel_j / float(found.mesh.length_m.sum())
    worth = np.where((rooms.by_f == 0.0) & (rooms.by_b == 0.0), metre / size, 1.0)
    return np.asarray(rooms.counts & (point.slack * worth < point.multiplier * size))


def codes(found: Found) -> IntArray:
    """Return a number for the limits that hold at each point, shape (n, points)."""
    holds = active(found)
    return np.asarray((holds * (1 << np.arange(len(holds)))[:, None, None]).sum(axis=0), dtype=np.int64)


def hard_edges(problem: Route, mesh: Mesh) -> BoolArray:
    """Return at which inner edges gear, slope or limit change, or standstill is near, shape (n − 1,)."""
    bent = np.isin(mesh.edges_m[1:-1], bends_of(problem))
    return np.asarray((np.diff(mesh.gear) != 0) | bent | (mesh.kind[1:] != mesh.kind[:-1]))


@dataclass(frozen=True, slots=True)
class Sequence:
    """All points of a drive in driving order, each array of shape (n · points,) or (m, n · points).

    Attributes
    ----------
    at_m, force_n : array
    impulse_j : array
        ∫ F ds of the quadrature's share of each point.
    code, part : int array
        Which limits hold, and the smooth piece of the road.
    slack, multiplier : array
    of_force : bool array, shape (m,)
        Whether a limit is one of force or brakes, not of energy.
    """

    at_m: FloatArray
    force_n: FloatArray
    impulse_j: FloatArray
    code: IntArray
    part: IntArray
    slack: FloatArray
    multiplier: FloatArray
    of_force: BoolArray


def kinks_of(problem: Route, found: Found) -> FloatArray:
    """Return the places inside smooth pieces of the road where other limits begin to hold, or full load bends."""
    return np.sort(np.concatenate((_changes_of(problem, found), _bends_of_full_load(problem, found))))


def _bends_of_full_load(problem: Route, found: Found) -> FloatArray:
    """Return where a drive at full load passes an engine speed at which the line of full load bends."""
    line = getattr(problem.engine, "full_load", ())
    mesh, motion = found.mesh, found.look.motion
    if not line or not mesh.ratio_radpm.any():
        return np.zeros(0)
    ratio = mesh.ratio_radpm[:, None]
    corners = np.array(line)[:, 0] * RADPS_PER_RPM
    top = np.interp(ratio * motion.speed_mps, corners, np.array(line)[:, 1]) * ratio
    full = (ratio[:, 0] > 0.0) & (motion.force_n >= NEARLY_FULL * top).any(axis=1)
    edges_mps = np.sqrt(2.0 * found.point.nodes_j[::DEGREE] / problem.load.accelerated_mass_kg)
    at = np.column_stack((mesh.edges_m[:-1], mesh.points_m, mesh.edges_m[1:]))[full]
    omega = np.column_stack((edges_mps[:-1], motion.speed_mps, edges_mps[1:]))[full] * ratio[full]
    places = []
    for corner in corners:
        off = omega - corner
        row, k = np.nonzero(off[:, 1:] * off[:, :-1] < 0.0)
        share = off[row, k] / (off[row, k] - off[row, k + 1])
        places.append(at[row, k] + share * (at[row, k + 1] - at[row, k]))
    return np.concatenate(places)


def _changes_of(problem: Route, found: Found) -> FloatArray:
    """Return the places inside smooth pieces of the road where other limits begin to hold."""
    mesh, rooms = found.mesh, found.look.rooms
    pieces = np.concatenate(([0], np.cumsum(hard_edges(problem, mesh))))
    m = len(found.point.slack)
    force = found.look.motion.force_n
    line = Sequence(
        mesh.points_m.ravel(), force.ravel(),
        (force * BASIS.weights[mesh.kind] * mesh.length_m[:, None]).ravel(), codes(found).ravel(),
        np.repeat(pieces, DEGREE), found.point.slack.reshape(m, -1), found.point.multiplier.reshape(m, -1),
        ((rooms.by_f != 0.0) | (rooms.by_b != 0.0)).ravel(),
    )  # fmt: skip
    changes = np.flatnonzero((np.diff(line.code) != 0) & (np.diff(line.part) == 0))
    if not len(changes):
        return np.zeros(0)
    groups = np.split(changes, np.flatnonzero(np.diff(changes) > DEGREE) + 1)
    return np.concatenate([_places(line, group, mesh) for group in groups])


def _places(line: Sequence, group: IntArray, mesh: Mesh) -> FloatArray:
    """Return the kinks of a group of changes that lie nearer together than an element's points.

    Where the force jumps from one limit to another its impulse says where. The costate there hangs on that place by
    micrometres, so the jump gets a tiny element of its own in which to find it.
    """
    before, after = int(group[0]), int(group[-1]) + 1
    first, last = before // DEGREE, after // DEGREE
    jump = line.force_n[after] - line.force_n[before]
    left, right = (_held(line, int(line.code[k])) for k in (before, after))
    if not (left - right and right - left):
        return np.array([_between(line, int(k)) for k in group])
    a, b = float(mesh.edges_m[first]), float(mesh.edges_m[last + 1])
    taken = float(line.impulse_j[first * DEGREE : (last + 1) * DEGREE].sum())
    place = float(np.clip(b - (taken - line.force_n[before] * (b - a)) / jump, a + JUMP_M, b - JUMP_M))
    return np.array([place - JUMP_M, place + JUMP_M])


def _held(line: Sequence, code: int) -> set[int]:
    """Return which limits of force hold."""
    return {i for i in np.flatnonzero(line.of_force).tolist() if code >> i & 1}


def _between(line: Sequence, k: int) -> float:
    """Return where between the points k and k + 1 a limit begins or ceases to hold."""
    low, high = float(line.at_m[k]), float(line.at_m[k + 1])
    differ = int(line.code[k] ^ line.code[k + 1])
    for limit in sorted((i for i in range(len(line.of_force)) if differ >> i & 1), key=lambda i: not line.of_force[i]):
        before = bool(line.code[k] >> limit & 1)
        if line.of_force[limit]:
            rows = _arc(line, k, backwards=before)
            values = line.multiplier[limit, rows]
        else:
            rows = _arc(line, k, backwards=not before)
            values = np.sqrt(line.slack[limit, rows])
        if len(rows) < 2:
            continue
        scale = high - low
        x = (line.at_m[rows] - 0.5 * (low + high)) / scale
        roots = np.roots(np.polyfit(x, values / np.abs(values).max(), len(rows) - 1))
        real = roots[np.abs(roots.imag) < 1e-6].real
        if len(real):
            root = float(real[np.abs(real).argmin()])
            return float(np.clip(0.5 * (low + high) + scale * root, low, high))
    return 0.5 * (low + high)


def _arc(line: Sequence, k: int, *, backwards: bool) -> IntArray:
    """Return the nearest points of the arc that ends at k, or begins behind it."""
    first = k if backwards else k + 1
    step = -1 if backwards else 1
    rows = [first]
    while len(rows) < AT_ONCE:
        j = rows[-1] + step
        if not 0 <= j < len(line.at_m) or line.code[j] != line.code[first] or line.part[j] != line.part[first]:
            break
        rows.append(j)
    return np.array(rows)


def cut_at(problem: Route, base: Mesh, kinks_m: FloatArray) -> Mesh:
    """Return a mesh with edges at kinks; soft edges beside them give way."""
    soft = ~hard_edges(problem, base)
    edges, gear = base.edges_m, base.gear
    element = np.clip(np.searchsorted(edges, kinks_m, side="right") - 1, 0, len(gear) - 1)
    room = np.minimum(kinks_m - edges[element], edges[element + 1] - kinks_m)
    kinks_m = np.unique(kinks_m[room > TINY_M])
    if not len(kinks_m):
        return base
    inner = edges[1:-1]
    near = np.abs(inner[:, None] - kinks_m).min(axis=1) < BESIDE * np.minimum(np.diff(edges)[:-1], np.diff(edges)[1:])
    kept = np.concatenate((edges[:1], inner[~(soft & near)], edges[-1:]))
    places = np.unique(np.concatenate((kept, kinks_m)))
    places = places[np.concatenate(([True], np.diff(places) > TINY_M))]
    middle = 0.5 * (places[1:] + places[:-1])
    return mesh_of(problem, places, gear[np.searchsorted(edges, middle, side="right") - 1])
