"""Normalised, centred columns in orthogonal form, made once for all the formulas laid through the same cells.

Every class of the thesis is a choice of columns of one matrix F. With root · (F − centre) / scale = q r factored once,
a formula's own factor is that of a few columns of r, and what it says of left-out cells needs no new factor at all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.fitting.cells import Cells, folds
from app.science.engine.fitting.terms import DEGREES, FitError, Term, TermSet

EVERY = TermSet("every", tuple((i, j) for i in range(max(DEGREES) + 1) for j in range(max(DEGREES) + 1)))
ALIKE = 1e-11


@dataclass(frozen=True, slots=True)
class Fold:
    """Cells that are left out together.

    Attributes
    ----------
    out : bool array, shape (n,)
    q : array, shape (cells of the fold, m)
        Their rows.
    gram : array, shape (m, m)
        qᵀq of these.
    """

    out: BoolArray
    q: FloatArray
    gram: FloatArray

    @staticmethod
    def of(q: FloatArray, out: BoolArray) -> Fold:
        """Take the rows of a fold out of those of all cells."""
        return Fold(out, q[out], q[out].T @ q[out])


@dataclass(frozen=True, slots=True)
class Basis:
    """The factored columns over some cells.

    Attributes
    ----------
    place : dict
        Column of each term.
    columns : array, shape (n, terms)
        In original units, unweighted.
    root : array, shape (n,)
        Square roots of the weights.
    centre, scale : array, shape (terms,)
        Weighted mean and deviation of each column; 0 and 1 for the constant, centre 0 where there is none.
    q, r : array, shape (n, m) and (m, terms)
    folds : tuple of Fold
    """

    place: dict[Term, int]
    columns: FloatArray
    root: FloatArray
    centre: FloatArray
    scale: FloatArray
    q: FloatArray
    r: FloatArray
    folds: tuple[Fold, ...]

    @staticmethod
    def of(cells: Cells, terms: TermSet = EVERY) -> Basis:
        """Factor the columns of these terms."""
        columns = terms.columns(cells.omega, cells.torque)
        share = cells.weight / cells.weight.sum()
        constant = terms.terms.index((0, 0)) if (0, 0) in terms.terms else None
        centre = share @ columns if constant is not None else np.zeros(columns.shape[1])
        scale = np.sqrt(share @ (columns - centre) ** 2)
        if constant is not None:
            centre[constant], scale[constant] = 0.0, 1.0
        scale[scale == 0.0] = 1.0  # the column is zero; that it tells nothing apart is found where it is used
        root = np.sqrt(cells.weight)
        q, r = np.linalg.qr(root[:, None] * (columns - centre) / scale)
        number = folds(cells)
        parts = tuple(Fold.of(q, number == k) for k in np.unique(number))
        return Basis({term: k for k, term in enumerate(terms.terms)}, columns, root, centre, scale, q, r, parts)

    def holds(self, terms: TermSet) -> bool:
        """Tell whether a formula can be solved for: its terms are there, and it has a constant if this has."""
        return set(terms.terms) <= self.place.keys() and ((0, 0) in terms.terms) == ((0, 0) in self.place)

    def chosen(self, terms: TermSet) -> Chosen:
        """Return what solves for a formula with some of the terms; raises `FitError` when they can't be told apart."""
        some = [self.place[term] for term in terms.terms]
        q, r = np.linalg.qr(self.r[:, some])
        diagonal = np.abs(np.diag(r))
        if len(diagonal) < len(some) or np.min(diagonal) < ALIKE * np.max(diagonal):
            raise FitError(
                "The cells lie so that some terms can't be told apart; choose a simpler formula or drive on."
            )
        back = np.diag(1.0 / self.scale[some])
        constant = terms.terms.index((0, 0)) if (0, 0) in terms.terms else None
        if constant is not None:
            back[constant] -= self.centre[some] / self.scale[some]
            back[constant, constant] = 1.0
        return Chosen(self, self.columns[:, some], q, r, back)

    def seen(self, y: FloatArray) -> FloatArray:
        """Return qᵀ · root · y, shape (m,), without a matrix library's threads: they cost more than they bring."""
        return np.asarray(np.einsum("ij,i->j", self.q, self.root * y))

    def design(self, terms: TermSet) -> FloatArray:
        """Return w, shape (m, terms), with root · columns = q w; the basis holds the constant and all the terms."""
        some = [self.place[term] for term in terms.terms]
        constant = self.r[:, self.place[0, 0]]
        return np.asarray(self.r[:, some] * self.scale[some] + np.outer(constant, self.centre[some]))


@dataclass(frozen=True, slots=True)
class Chosen:
    """The least-squares problem of one formula: its columns are basis.q · q · r, and ``back`` undoes the scaling."""

    basis: Basis
    columns: FloatArray
    q: FloatArray
    r: FloatArray
    back: FloatArray

    def coefficients(self, y: FloatArray) -> FloatArray:
        """Return the coefficients in original units, once refined."""
        first = self._solve(y)
        return first + self._solve(self.left(y, first))

    def left(self, y: FloatArray, coefficients: FloatArray) -> FloatArray:
        """Return what a formula with these coefficients leaves over of y, shape (n,)."""
        return np.asarray(y - np.einsum("ij,j->i", self.columns, coefficients))

    def _solve(self, y: FloatArray) -> FloatArray:
        aim = self.q.T @ self.basis.seen(y)
        return np.asarray(self.back @ np.linalg.solve(self.r, aim))

    def spread(self) -> FloatArray:
        """Return (FᵀWF)⁻¹ in original units."""
        root = self.back @ np.linalg.inv(self.r)
        return np.asarray(root @ root.T)

    def left_out(self, left: FloatArray) -> FloatArray:
        """Return each cell's error under the fit that leaves out its whole fold, without fitting anew."""
        errors = self.basis.root * left
        for fold in self.basis.folds:
            own = errors[fold.out]
            rest = np.eye(self.q.shape[1]) - self.q.T @ fold.gram @ self.q
            moved = np.linalg.lstsq(rest, self.q.T @ (fold.q.T @ own), rcond=None)[0]
            errors[fold.out] = own + fold.q @ (self.q @ moved)
        return errors / self.basis.root
