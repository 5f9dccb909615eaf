"""Whether another control beats a drive anywhere: the largest H − μ over a dense grid of controls, along the drive."""

from __future__ import annotations

import numpy as np

from app.science.arrays import IntArray
from app.science.optimal.problem import Route
from app.science.optimal.route.polish.burning import Powertrain
from app.science.optimal.route.polish.gains import grid_gain_w
from app.science.optimal.route.polish.interior_point import Found
from app.science.optimal.route.polish.kinks import JUMP_M
from app.science.optimal.route.polish.tracing import Traced

LOOKS = 300
SLOWEST_MPS = 0.01


def looked_at(found: Found) -> tuple[IntArray, IntArray]:
    """Return elements and points at which controls are compared; where the force jumps none is looked at."""
    elements = np.flatnonzero(found.mesh.length_m > 3.0 * JUMP_M)
    grid = np.stack(np.meshgrid(elements, np.arange(1, found.look.fuel.value.shape[1] + 1), indexing="ij"))
    every = grid.reshape(2, -1)
    some = every[:, np.unique(np.linspace(0, every.shape[1] - 1, LOOKS).astype(np.int64))]
    return some[0], some[1]


def largest_h_minus_mu_w(problem: Route, power: Powertrain, found: Found, drive: Traced) -> float:
    """Return the largest H − μ of any admissible control along a drive, W.

    With charges for shifts the gear is the drive's own; else every gear that the engine's speed allows, and neutral.
    """
    e, k = looked_at(found)
    v = drive.speed_mps[e, k]
    slow = v < SLOWEST_MPS
    e, k, v = e[~slow], k[~slow], v[~slow]
    p, price = drive.costate[e, k], drive.price_jpm[e, k]
    load, mu = problem.load, found.point.price_w
    against = load.drag_kgpm * v**2 + found.mesh.slope_n[e]
    own = found.mesh.gear[e] if problem.transmission.shift_cost_j > 0.0 else None
    gain = grid_gain_w(problem, power, p, v, own)
    return float((v * price - mu - p * against * v + gain).max())
