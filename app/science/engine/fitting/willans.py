"""Fuel power over engine power: Willans lines with a friction that grows with engine speed, monotone and convex.

P_in = k₀ + k₁ ω + k₂ ω² + a ωT + b ωT², every coefficient at least zero: fuel never falls with load, and each further
watt of ωT costs at least as much as the one before. The first four terms are Willans' line with a friction that depends
on engine speed, the last one bends it towards full load. Where the data want it otherwise, that is said.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.fitting.basis import Basis
from app.science.engine.fitting.cells import Cells
from app.science.engine.fitting.polynomial import Formula, enough, judged
from app.science.engine.fitting.terms import TermSet

WILLANS = TermSet("Willans", ((0, 0), (1, 0), (2, 0), (1, 1), (1, 2)))
SIGNIFICANT = 3.0
UNSEEN = 1e-12


@dataclass(frozen=True, slots=True)
class WillansFit:
    """A monotone, convex fuel model.

    Attributes
    ----------
    formula : Formula
        Of P_in; a coefficient that the data want below zero is 0, without a deviation.
    non_convexity : float
        How many standard errors the freely fitted curvature in torque is below zero; 0 when it isn't. Above 3 the data
        contradict a convex model, and steady driving at the best point may lose against pulse and glide.
    """

    formula: Formula
    non_convexity: float


def fit_willans(cells: Cells, basis: Basis | None = None) -> WillansFit:
    """Fit the model to the cells of a map; raises `FitError` when there are too few.

    Parameters
    ----------
    cells : Cells
    basis : Basis, optional
        Of the same cells, to be shared with other formulas.
    """
    enough(cells, WILLANS)
    basis = basis or Basis.of(cells)
    y, columns = cells.values("p_in"), WILLANS.columns(cells.omega, cells.torque)
    design, aim = basis.design(WILLANS), basis.seen(y)
    scale = np.sqrt(np.sum(design**2, axis=0))
    design = design / scale
    scaled = nonnegative_least_squares(design, aim)
    free = scaled > 0.0
    spread = np.zeros((len(scale), len(scale)))
    spread[np.ix_(free, free)] = np.linalg.pinv(design[:, free].T @ design[:, free])
    left_out = np.empty(len(y))
    for fold in basis.folds:
        share, axes = np.linalg.eigh(np.eye(len(aim)) - fold.gram)
        seen = share > UNSEEN
        root = axes[:, seen] * np.sqrt(share[seen])
        others = axes[:, seen].T @ (aim - fold.q.T @ (basis.root * y)[fold.out]) / np.sqrt(share[seen])
        without = nonnegative_least_squares(root.T @ design, others) / scale
        left_out[fold.out] = y[fold.out] - columns[fold.out] @ without
    left = y - columns @ (scaled / scale)
    formula = judged(cells, "p_in", WILLANS, scaled / scale, spread / np.outer(scale, scale), left, left_out)
    return WillansFit(formula, _non_convexity(design, aim, basis.root * y))


def nonnegative_least_squares(design: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return x ≥ 0 that minimises |design · x − wanted|, for a handful of columns.

    The solution is the plain least-squares one on the columns where it is positive, so trying all sets of columns finds
    it exactly.

    Parameters
    ----------
    design : array, shape (n, k)
    wanted : array, shape (n,)
    """
    q, r = np.linalg.qr(design)
    aim, width = q.T @ wanted, design.shape[1]
    best, least = np.zeros(width), float(aim @ aim)
    for size in range(width, 0, -1):
        for some in combinations(range(width), size):
            own = r[:, some]
            found = np.linalg.lstsq(own, aim, rcond=None)[0]
            rest = aim - own @ found
            if (found >= 0.0).all() and rest @ rest < least:
                best, least = np.zeros(width), float(rest @ rest)
                best[list(some)] = found
                if size == width:
                    return best  # nothing is held at zero, so nothing could be better
    return best


def _non_convexity(design: FloatArray, aim: FloatArray, wanted: FloatArray) -> float:
    """Return by how many standard errors the curvature term, the last one, wants to be negative."""
    free = np.linalg.lstsq(design, aim, rcond=None)[0]
    left = aim - design @ free
    unexplained = float(left @ left) + max(float(wanted @ wanted - aim @ aim), 0.0)
    variance = unexplained / (len(wanted) - design.shape[1])
    spread = np.linalg.pinv(design.T @ design)
    return max(0.0, -float(free[-1]) / float(np.sqrt(variance * spread[-1, -1]))) if variance > 0.0 else 0.0
