"""Fuel and time for a metre over kinetic energy and force, and the limits of both, at the points of a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.problem import RoadLoad
from app.science.optimal.route.polish.basis import BASIS
from app.science.optimal.route.polish.burning import Burned, ForceLimit, Powertrain
from app.science.optimal.route.polish.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Motion:
    """A drive at the points of its mesh, each array of shape (n, points).

    Attributes
    ----------
    energy_j, speed_mps : array
    force_n : array
        At the wheels, brakes counted as negative.
    """

    energy_j: FloatArray
    speed_mps: FloatArray
    force_n: FloatArray


@dataclass(frozen=True, slots=True)
class PerMetre:
    """A quantity for a metre and its derivatives by energy E and force F, each array of shape (n, points)."""

    value: FloatArray
    by_e: FloatArray
    by_f: FloatArray
    by_ee: FloatArray
    by_ef: FloatArray
    by_ff: FloatArray


@dataclass(frozen=True, slots=True)
class Limit:
    """A room that a drive must leave, and its derivatives by energy and force, each array of shape (n, points).

    ``by_f`` is +1 or −1 for a limit of the force and 0 for one of the energy.
    """

    room: FloatArray
    by_e: FloatArray
    by_ee: FloatArray
    by_f: float


def motion_on(mesh: Mesh, load: RoadLoad, nodes_j: FloatArray) -> Motion:
    """Return the drive whose energies at the nodes are given: F = E′ + (2 r₂/M_a) E + r₀(s)."""
    local = mesh.at_nodes(nodes_j)
    energy = np.einsum("eqn,en->eq", BASIS.value[mesh.kind], local)
    slope = np.einsum("eqn,en->eq", BASIS.slope[mesh.kind], local) / mesh.length_m[:, None]
    with np.errstate(invalid="ignore"):  # a trial step may leave the road; its energy below zero shows as NaN
        speed = np.sqrt(2.0 * energy / load.accelerated_mass_kg)
    return Motion(energy, speed, slope + drag_per_energy(load) * energy + mesh.slope_n[:, None])


def drag_per_energy(load: RoadLoad) -> float:
    """Return by how much drag grows with kinetic energy, 1/m."""
    return 2.0 * load.drag_kgpm / load.accelerated_mass_kg


def fuel_per_metre(burned: Burned, speed_mps: FloatArray, mass_kg: float) -> PerMetre:
    """Return P/v over energy and force."""
    v, p = speed_mps, burned.power_w
    by_v = (burned.by_v - p / v) / v
    by_vv = (burned.by_vv - 2.0 * by_v) / v
    dv, ddv = 1.0 / (mass_kg * v), -1.0 / (mass_kg**2 * v**3)
    return PerMetre(
        p / v, by_v * dv, burned.by_f / v, by_vv * dv**2 + by_v * ddv, (burned.by_vf - burned.by_f / v) / v * dv,
        burned.by_ff / v,
    )  # fmt: skip


def time_per_metre(speed_mps: FloatArray, mass_kg: float) -> PerMetre:
    """Return 1/v over energy and force."""
    v = speed_mps
    none = np.zeros(v.shape)
    return PerMetre(1.0 / v, -1.0 / (mass_kg * v**3), none, 3.0 / (mass_kg**2 * v**5), none, none)


def limits_at(mesh: Mesh, power: Powertrain, motion: Motion, pull_n: FloatArray, mass_kg: float) -> list[Limit]:
    """Return the rooms of energy and of the engine's force ``pull_n``, at every point.

    Where neutral has no brakes its force is 0 and neither side has room; such points are an equation.
    """
    v, ratio = motion.speed_mps, mesh.ratio_radpm[:, None]
    none = np.zeros(v.shape)
    low = by_speed(power.lowest(v, ratio), v, mass_kg)
    return [
        Limit(motion.energy_j - mesh.least_j[:, None], none + 1.0, none, 0.0),
        Limit(mesh.most_j[:, None] - motion.energy_j, none - 1.0, none, 0.0),
        Limit(pull_n - low.room, -low.by_e, -low.by_ee, 1.0),
        *(replace(one, room=one.room - pull_n, by_f=-1.0)
          for one in (by_speed(high, v, mass_kg) for high in power.highest(v, ratio))),
    ]  # fmt: skip


def by_speed(limit: ForceLimit, speed_mps: FloatArray, mass_kg: float) -> Limit:
    """Return a limit of a force over energy instead of speed."""
    dv, ddv = 1.0 / (mass_kg * speed_mps), -1.0 / (mass_kg**2 * speed_mps**3)
    return Limit(limit.force_n, limit.by_v * dv, limit.by_vv * dv**2 + limit.by_v * ddv, 0.0)
