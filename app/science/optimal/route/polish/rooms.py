"""All that a drive must leave room for, stacked: energy, engine force and brakes at points, energy at edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.optimal.route.polish.burning import Powertrain
from app.science.optimal.route.polish.lagrangian import Limit, Motion, by_speed, limits_at
from app.science.optimal.route.polish.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Rooms:
    """Rooms at the points of a mesh, m of them at each.

    Attributes
    ----------
    room, by_e, by_ee : array, shape (m, n, points)
    by_f, by_b : array, shape (m, 1, 1)
        By the force at the wheels and by the brakes.
    counts : bool array, shape (m, n, points)
        False where a force is held by an equation instead.
    """

    room: FloatArray
    by_e: FloatArray
    by_ee: FloatArray
    by_f: FloatArray
    by_b: FloatArray
    counts: BoolArray


def holds_back(power: Powertrain, brake_max_n: float) -> bool:
    """Tell whether brakes, or the drive itself, hold the car back wherever it is."""
    return power.brakes_anywhere and (brake_max_n > 0.0 or len(power.retards(np.ones(1))) > 0)


def rolls_freely(mesh: Mesh, power: Powertrain, brake_max_n: float) -> BoolArray:
    """Return in which elements nothing acts on the car but the road, shape (n,)."""
    return np.asarray((mesh.ratio_radpm == 0.0) & (brake_max_n == 0.0 and not power.brakes_anywhere))


def rooms_at(
    mesh: Mesh, power: Powertrain, motion: Motion, brake_n: FloatArray, brake_max_n: float, mass_kg: float
) -> Rooms:
    """Return the rooms of a drive.

    Parameters
    ----------
    mesh, power, motion
    brake_n : array, shape (n, points)
        Of what holds the car back beside the engine's least force; 0 where nothing does.
    brake_max_n, mass_kg : float
    """
    limits = limits_at(mesh, power, motion, motion.force_n + brake_n, mass_kg)
    room, by_e, by_ee = ([getattr(one, name) for one in limits] for name in ("room", "by_e", "by_ee"))
    by_f = [one.by_f for one in limits]
    by_b = list(by_f)
    if holds_back(power, brake_max_n):
        none = np.zeros(brake_n.shape)
        most = [by_speed(one, motion.speed_mps, mass_kg) for one in power.retards(motion.speed_mps)]
        most = most or [Limit(none, none, none, 0.0)]
        room += [brake_n, *(brake_max_n + one.room - brake_n for one in most)]
        by_e += [none, *(one.by_e for one in most)]
        by_ee += [none, *(one.by_ee for one in most)]
        by_f += [0.0] * (1 + len(most))
        by_b += [1.0, *[-1.0] * len(most)]
    else:
        by_b = [0.0] * len(by_f)
    free = rolls_freely(mesh, power, brake_max_n)
    counts = np.ones((len(room), *brake_n.shape), dtype=np.bool_)
    counts[np.ix_(np.array(by_f) != 0.0, free)] = False
    return Rooms(
        np.array(room), np.array(by_e), np.array(by_ee), np.array(by_f)[:, None, None], np.array(by_b)[:, None, None],
        counts,
    )  # fmt: skip


def edge_bounds_j(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Return lowest and highest energies at the edges, shape (n + 1,); both neighbours' limits hold."""
    low = np.maximum(np.append(mesh.least_j[0], mesh.least_j), np.append(mesh.least_j, mesh.least_j[-1]))
    high = np.minimum(np.append(mesh.most_j[0], mesh.most_j), np.append(mesh.most_j, mesh.most_j[-1]))
    return low, high
