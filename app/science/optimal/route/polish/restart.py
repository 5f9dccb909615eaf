"""From the best drive on one mesh to a start on another one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.route.polish.basis import BASIS, DEGREE
from app.science.optimal.route.polish.interior_point import Found
from app.science.optimal.route.polish.iterate import Point
from app.science.optimal.route.polish.mesh import Mesh


def energies_at(mesh: Mesh, nodes_j: FloatArray, at_m: FloatArray) -> FloatArray:
    """Return the energies of a drive on a mesh at places of the road."""
    k = np.clip(np.searchsorted(mesh.edges_m, at_m, side="right") - 1, 0, len(mesh.gear) - 1)
    x = (at_m - mesh.edges_m[k]) / mesh.length_m[k]
    powers = x[:, None] ** np.arange(DEGREE + 1) @ np.linalg.inv(np.vander(BASIS.nodes, increasing=True))
    return np.asarray((powers * mesh.at_nodes(nodes_j)[k]).sum(axis=1))


def carried(before: Found, mesh: Mesh, start: Point, barrier: float) -> Point:
    """Give a start the multipliers that were found near by, and slacks that fit them.

    Parameters
    ----------
    before : Found
    mesh : Mesh
        Of the start.
    start : Point
        Slacks and multipliers whose product is the barrier's weight.
    barrier : float
        Of what a metre costs.
    """
    tau = barrier * before.look.fuel_j / float(before.mesh.length_m.sum())
    old, new = before.mesh.points_m.ravel(), mesh.points_m.ravel()
    after = np.clip(np.searchsorted(old, new), 1, len(old) - 1)
    near = np.where(new - old[after - 1] < old[after] - new, after - 1, after)
    shape = start.slack.shape
    known = before.point.multiplier.reshape(shape[0], -1)[:, near].reshape(shape)
    held = known * start.slack > tau
    slack = np.where(held, tau / np.maximum(known, 1e-300), start.slack)
    edge_old = np.searchsorted(before.mesh.edges_m, mesh.edges_m)
    same = before.mesh.edges_m[np.minimum(edge_old, len(before.mesh.gear))] == mesh.edges_m
    edge_known = np.where(same, before.point.edge_multiplier[:, np.minimum(edge_old, len(before.mesh.gear))], 0.0)
    edge_held = edge_known * start.edge_slack > tau
    edge_slack = np.where(edge_held, tau / np.maximum(edge_known, 1e-300), start.edge_slack)
    return replace(
        start,
        slack=slack,
        multiplier=tau / slack,
        edge_slack=edge_slack,
        edge_multiplier=tau / edge_slack,
        rolling=before.point.rolling.ravel()[near].reshape(start.rolling.shape),
    )
