"""What no drive can go below: weak duality with the drive's own costates, minimised point by point over everything.

For any function p of the place, ∫ (P/v) ds ≥ ∫ min [(P + μ)/v − p E′ − p′ E] ds + p E at the end less p E at the
begin, less μ times the longest time; the minimum is over all energies within the limits and over all controls. With p
from the drive the bound meets its fuel where nothing is better than the drive. No derivative and no step of the method
that found the drive enters."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.problem import Route
from app.science.optimal.route.polish.basis import BASIS, DEGREE, FROM_REST, TO_REST
from app.science.optimal.route.polish.burning import Powertrain
from app.science.optimal.route.polish.gains import Gain, gain_of
from app.science.optimal.route.polish.hamiltonian import touches
from app.science.optimal.route.polish.interior_point import Found
from app.science.optimal.route.polish.lagrangian import drag_per_energy
from app.science.optimal.route.polish.rooms import edge_bounds_j
from app.science.optimal.route.polish.tracing import Traced

ENERGIES = 41
AT_ONCE = 2000
NEAR = np.concatenate((-np.geomspace(1e-1, 1e-4, 8), [0.0], np.geomspace(1e-4, 1e-1, 8)))
"""Energies beside the drive's own, of it."""


def lower_bound_j(problem: Route, power: Powertrain, found: Found, drive: Traced) -> float:
    """Return what no drive within the limits burns less than, charges for shifts aside, J."""
    mesh, mu = found.mesh, found.point.price_w
    every, slope = _function(found, drive)
    p = every[:, 1:-1]
    least = np.broadcast_to(mesh.least_j[:, None], p.shape)
    most = np.broadcast_to(mesh.most_j[:, None], p.shape)
    against = np.broadcast_to(mesh.slope_n[:, None], p.shape)
    places = [one.reshape(-1) for one in (p, slope, least, most, against, found.look.motion.energy_j)]
    gain = gain_of(problem, power)
    cheapest = np.concatenate(
        [_cheapest(problem, mu, gain, *(one[a : a + AT_ONCE] for one in places)) for a in range(0, p.size, AT_ONCE)]
    )
    weight = (BASIS.weights[mesh.kind] * mesh.length_m[:, None]).reshape(-1)
    low, high = edge_bounds_j(mesh)
    jump = every[:-1, -1] - every[1:, 0]
    ends = every[-1, -1] * mesh.end_j - every[0, 0] * mesh.begin_j
    total = float((weight * cheapest).sum()) + ends
    total += float(np.minimum(jump * low[1:-1], jump * high[1:-1]).sum())
    return float(total - mu * (problem.max_time_s or 0.0))


def _function(found: Found, drive: Traced) -> tuple[FloatArray, FloatArray]:
    """Return p by elements, at begin, points and end, and its derivative at the points.

    It is the costate, made continuous but where the drive touches a limit of its speed and it jumps as that limit makes
    it: elsewhere only rounding and the last centimetres of a kink do. In the element at standstill p grows like one
    over the root of the distance, as the costate does.
    """
    mesh = found.mesh
    upper = found.point.edge_multiplier[1, 1:-1] > found.point.edge_multiplier[0, 1:-1]
    falls = drive.costate[:-1, -1] < drive.costate[1:, 0]
    jumps = touches(found) & (upper == falls)
    middle = 0.5 * (drive.costate[:-1, -1] + drive.costate[1:, 0])
    if mesh.kind[0] == FROM_REST:
        middle[0] = drive.costate[1, 0]
    if mesh.kind[-1] == TO_REST:
        middle[-1] = drive.costate[-2, -1]
    begin, end = drive.costate[:, 0].copy(), drive.costate[:, -1].copy()
    begin[1:] = np.where(jumps, begin[1:], middle)
    end[:-1] = np.where(jumps, end[:-1], middle)
    share = np.column_stack((np.zeros(len(begin)), BASIS.points[mesh.kind], np.ones(len(begin))))
    left, right = begin - drive.costate[:, 0], end - drive.costate[:, -1]
    every = drive.costate + left[:, None] * (1.0 - share) + right[:, None] * share
    slope = np.einsum("eqk,ek->eq", _derivative()[mesh.kind], every[:, 1:-1]) / mesh.length_m[:, None]
    for element, kind, away in ((0, FROM_REST, share[0]), (-1, TO_REST, 1.0 - share[-1])):
        if mesh.kind[element] == kind:
            inner, length = away[1:-1], mesh.length_m[element]
            at_edge = end[0] if kind == FROM_REST else begin[-1]
            every[element] = at_edge
            every[element, 1:-1] = at_edge / np.sqrt(inner)
            sign = -0.5 if kind == FROM_REST else 0.5
            slope[element] = sign * every[element, 1:-1] / (inner * length)
    return every, slope


def _derivative() -> FloatArray:
    """Return derivatives at an element's points from values there, for each kind of element."""
    gauss = 0.5 * (np.polynomial.legendre.leggauss(DEGREE)[0] + 1.0)
    powers = np.arange(DEGREE)
    slopes = np.column_stack((np.zeros(DEGREE), powers[1:] * gauss[:, None] ** (powers[1:] - 1)))
    plain = slopes @ np.linalg.inv(np.vander(gauss, increasing=True))
    stretch = np.array([np.ones(DEGREE), 2.0 * gauss, 2.0 * (1.0 - gauss)])
    return np.asarray(plain / stretch[..., None])


def _cheapest(
    problem: Route, mu_w: float, gain: Gain, p: FloatArray, slope: FloatArray, least: FloatArray, most: FloatArray,
    against: FloatArray, own: FloatArray,
) -> FloatArray:  # fmt: skip
    """Return the least of (P + μ)/v − p E′ − p′ E over energies and controls at places, J/m."""
    share = np.linspace(0.0, 1.0, ENERGIES)
    energy = np.concatenate((least[:, None] + share * (most - least)[:, None], own[:, None] * (1.0 + NEAR)), axis=1)
    energy = np.clip(energy, least[:, None], most[:, None])
    v = np.sqrt(2.0 * energy / problem.load.accelerated_mass_kg)
    every = np.broadcast_to(p[:, None], v.shape)
    resisted = drag_per_energy(problem.load) * energy + against[:, None]
    with np.errstate(divide="ignore"):  # at standstill a metre costs infinitely much
        metre = (mu_w - gain(every, v)) / v + every * resisted - slope[:, None] * energy
    return np.asarray(metre.min(axis=1))
