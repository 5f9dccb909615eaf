"""Where gears change: places are moved until a metre costs the same on both sides, by Newton on the whole drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.problem import Route
from app.science.optimal.route.polish.basis import BASIS, DEGREE
from app.science.optimal.route.polish.interior_point import Found, InteriorPoint
from app.science.optimal.route.polish.lagrangian import drag_per_energy
from app.science.optimal.route.polish.mesh import Mesh, mesh_of
from app.science.optimal.route.polish.newton import reduced

SHORTEST_M = 1.0
"""No gear is kept for less."""
FARTHEST = 0.4
"""Of the shorter neighbour, by which a change moves at once."""
LIMITED = 1e-6
FLAT = 1e-6


@dataclass(frozen=True, slots=True)
class Switches:
    """Changes of gear.

    Attributes
    ----------
    at_m : array, shape (k,)
    gears : int array, shape (k + 1,)
        Neighbours differ.
    defect_jpm : array, shape (k,)
        What a metre costs more before the change than behind it: the derivative of the cost by its place.
    speed_mps : array, shape (k,)
    step_m : array, shape (k,)
        Newton's step, with everything else following.
    """

    at_m: FloatArray
    gears: IntArray
    defect_jpm: FloatArray
    speed_mps: FloatArray
    step_m: FloatArray

    @property
    def defects_w(self) -> FloatArray:
        """Jumps of H."""
        return np.abs(self.defect_jpm) * self.speed_mps


def switches_of(method: InteriorPoint, found: Found, radius_m: float) -> Switches:
    """Return the changes of gear of a drive and where they want to go, none farther than a radius."""
    mesh, look, point = found.mesh, found.look, found.point
    before = np.flatnonzero(np.diff(mesh.gear))
    at, speed = mesh.edges_m[before + 1], np.sqrt(2.0 * mesh.at_nodes(point.nodes_j)[before, -1] / method.mass_kg)
    gears = mesh.gear[np.append(before, len(mesh.gear) - 1)]
    if not len(before):
        return Switches(at, gears, np.zeros(0), speed, np.zeros(0))
    factor, ef, ff = _factor(method, found)
    rooms = look.rooms
    n = np.where(rooms.counts, point.multiplier, 0.0)
    by_e = look.fuel.by_e + point.price_w * look.time.by_e - (n * rooms.by_e).sum(axis=0)
    by_f = look.fuel.by_f - (n * rooms.by_f).sum(axis=0) + point.rolling
    length = mesh.length_m[:, None]
    rise = look.motion.force_n - drag_per_energy(method.problem.load) * look.motion.energy_j - mesh.slope_n[:, None]
    weight = BASIS.weights[mesh.kind]
    metre = look.fuel.value + point.price_w * look.time.value - by_f * rise
    stretch = _Stretch(method, weight, by_e - ef * rise, -ff * rise, by_f, length)
    longer = (weight * metre).sum(axis=1)
    # a change at a road point is compared on one slope: it goes to where the road is one or the other
    costate = 0.5 * (by_f[before, -1] + by_f[before + 1, 0])
    defect = longer[before] - longer[before + 1] + costate * np.diff(mesh.slope_n)[before]
    own = (weight * ff * rise**2 / length).sum(axis=1)
    curved = np.diag(own[before] + own[before + 1])
    for k in range(len(before) - 1):
        if before[k] + 1 == before[k + 1]:
            curved[k, k + 1] = curved[k + 1, k] = -own[before[k + 1]]
    cross = np.array([stretch.gradient(int(e)) - stretch.gradient(int(e) + 1) for e in before]).T
    slower = (weight * look.time.value).sum(axis=1)
    border = method.assembly.gradient(look.time.by_e, look.time.by_f)[1:-1]
    both = cho_solve_banded((factor, False), np.column_stack((cross[1:-1], border)), check_finite=False)
    matrix = curved - cross[1:-1].T @ both[:, :-1]
    matrix = 0.5 * (matrix + matrix.T)
    late = slower[before] - slower[before + 1] - cross[1:-1].T @ both[:, -1]
    tight = method.limited and point.price_w > LIMITED * point.time_slack_s
    step = _bent(matrix, late if tight else 0.0 * late, -float(border @ both[:, -1]), defect, radius_m)
    return Switches(at, gears, defect, speed, step)


def _factor(method: InteriorPoint, found: Found) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the factorised Hessian over the energies, and its parts by force at the points."""
    for convex in (False, True):
        quadratic, edges = method.model(found.point, found.look, found.barrier, convex=convex)
        _, _, ee, ef, ff = reduced(quadratic)
        try:
            band = method.assembly.banded(ee, ef, ff, edges[1])[:, 1:-1]
            return cholesky_banded(band, check_finite=False), ef, ff
        except LinAlgError:
            continue  # the convex one always has a factor, but for rounding
    band[DEGREE] += np.abs(band[DEGREE])
    return cholesky_banded(band, check_finite=False), ef, ff


class _Stretch:
    """Derivatives of the gradient by an element's length."""

    def __init__(
        self, method: InteriorPoint, weight: FloatArray, by_e: FloatArray, by_f: FloatArray, costate: FloatArray,
        length: FloatArray,
    ) -> None:  # fmt: skip
        asm = method.assembly
        local = (weight * by_e)[:, None, :] @ asm.value + (weight * by_f)[:, None, :] @ asm.force
        drag = drag_per_energy(method.problem.load)
        self.local = (local + drag * ((weight * costate)[:, None, :] @ asm.value))[:, 0, :]
        self.size = asm.size

    def gradient(self, element: int) -> FloatArray:
        """Return the derivative of the gradient by an element's length, shape (size,)."""
        whole = np.zeros(self.size)
        whole[element * DEGREE : (element + 1) * DEGREE + 1] = self.local[element]
        return whole


def _bent(matrix: FloatArray, late: FloatArray, corner: float, defect: FloatArray, radius_m: float) -> FloatArray:
    """Return the step to where the defects vanish, downhill in every direction; the time stays what it is."""
    matrix = matrix - np.outer(late, late) / corner
    values, vectors = np.linalg.eigh(matrix)
    size = FLAT * float(np.median(np.abs(values)))  # a limit may make some directions as stiff as its barrier
    downhill, values = vectors.T @ defect, np.maximum(np.abs(values), size)
    more = 0.0
    while np.abs(step := -vectors @ (downhill / (values + more))).max() > radius_m:
        more = max(2.0 * more, size)
    return np.asarray(step)


def moved(switches: Switches, begin_m: float, end_m: float) -> FloatArray:
    """Return where the changes go: by their steps, and never past a neighbour."""
    places = np.concatenate(([begin_m], switches.at_m, [end_m]))
    room = np.maximum(np.diff(places) - SHORTEST_M, 0.0)
    step = np.clip(switches.step_m, -FARTHEST * room[:-1], FARTHEST * room[1:])
    return np.asarray(switches.at_m + step)


def rescheduled(problem: Route, base: Mesh, old_m: FloatArray, switches_m: FloatArray, gears: IntArray) -> Mesh:
    """Return a mesh whose gears change at other places; edges that were there for the old changes are gone."""
    inner = base.edges_m[1:-1]
    hard = np.isin(inner, problem.road.distance_m)
    near = np.abs(inner[:, None] - switches_m).min(axis=1) < 0.5 * SHORTEST_M
    kept = inner[hard | ~(np.isin(inner, old_m) | near)]
    places = np.unique(np.concatenate((base.edges_m[[0, -1]], kept, switches_m)))
    middle = 0.5 * (places[1:] + places[:-1])
    return mesh_of(problem, places, gears[np.searchsorted(switches_m, middle)])


def free(switches: Switches, begin_m: float, end_m: float) -> BoolArray:
    """Return which changes have room on the side to which they want to go."""
    room = np.diff(np.concatenate(([begin_m], switches.at_m, [end_m]))) > 1.01 * SHORTEST_M
    return np.asarray(np.where(switches.defect_jpm > 0.0, room[:-1], room[1:]))
