"""Least-squares formulas for η, φ = 1/η or P_in over the trusted cells of a map (Sebesta 2010, 3.4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.fitting.terms import FitError, TermSet, chosen_terms, classes

Target = Literal["eta", "phi", "p_in"]
TARGETS: tuple[Target, ...] = ("eta", "phi", "p_in")
RADPS_PER_RPM = np.pi / 30.0
FOLDS = 10
BLOCK_RPM, BLOCK_NM = 250.0, 10.0
SPARE_CELLS = 5
LOWEST_EFFICIENCY = 1e-3
ALIKE = 1e-11


@dataclass(frozen=True, slots=True)
class Cells:
    """What a formula is fitted through, each array of shape (n,): rad/s, Nm, 1, and each cell's weight."""

    omega: FloatArray
    torque: FloatArray
    efficiency: FloatArray
    weight: FloatArray

    def values(self, target: Target) -> FloatArray:
        """Return the target's values: η, 1/η, or P_in = ωT/η in watts."""
        if target == "eta":
            return self.efficiency
        inverse = 1.0 / self.efficiency
        return inverse if target == "phi" else self.omega * self.torque * inverse

    def __len__(self) -> int:
        return len(self.omega)


@dataclass(frozen=True, slots=True)
class PolynomialFit:
    """A formula with its coefficients and how good it is.

    Attributes
    ----------
    target : {"eta", "phi", "p_in"}
    terms : TermSet
    coefficients, sd : array, shape (terms,)
        In original units: ω in rad/s, T in Nm, P in W.
    r_squared : float
        Coefficient of determination over the cells fitted.
    rmse : float
        In the target's unit.
    cross_validated : float
        Root mean square error on cells left out, in the target's unit.
    cross_validated_eta, cross_validated_eta_sd : float
        The same after turning the formula into η, which makes targets comparable; and its standard error.
    cells : int
    """

    target: Target
    terms: TermSet
    coefficients: FloatArray
    sd: FloatArray
    r_squared: float
    rmse: float
    cross_validated: float
    cross_validated_eta: float
    cross_validated_eta_sd: float
    cells: int

    def values(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return the formula's target at these engine speeds (rad/s) and torques (Nm)."""
        return self.terms.columns(omega, torque) @ self.coefficients

    def efficiency(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return η; NaN where the formula has no meaning, as for a fuel power that isn't positive."""
        return as_efficiency(self.target, self.values(omega, torque), omega, torque)


def trusted_cells(efficiency_map: EfficiencyMap, *, weighted: bool = False) -> Cells:
    """Return the trusted cells of a map; weighted, a cell counts by how well its mean is known.

    Raises
    ------
    FitError
        When they are too few, or all at one engine speed or one torque.
    """
    m = efficiency_map
    known = np.isfinite(m.efficiency) & (m.efficiency > LOWEST_EFFICIENCY) & (m.nm > 0.0) & (m.rpm > 0.0)
    rpm, nm = m.rpm[known], m.nm[known]
    if len(rpm) < SPARE_CELLS + 1:
        raise FitError(f"The map has {len(rpm)} trusted cells; a formula needs more. Drive on, then try again.")
    for values, what, unit in ((rpm, "engine speed", "rpm"), (nm, "torque", "Nm")):
        if np.ptp(values) == 0.0:
            raise FitError(
                f"All trusted cells are at one {what} ({values[0]:g} {unit}), so nothing tells how efficiency changes "
                "with it. Drive with others, too."
            )
    weight = np.ones(len(rpm))
    if weighted:
        error = np.maximum(m.sd[known], 0.005) ** 2 / m.n[known]
        weight = np.min(error) / np.where(np.isfinite(error), error, np.max(error[np.isfinite(error)]))
    return Cells(rpm * RADPS_PER_RPM, nm, m.efficiency[known], weight)


def fit(cells: Cells, target: Target, terms: TermSet) -> PolynomialFit:
    """Fit one formula by weighted least squares on normalised, centred columns.

    Raises
    ------
    FitError
        When the cells are fewer than the terms and `SPARE_CELLS` more, or don't tell the terms apart.
    """
    if len(cells) < len(terms.terms) + SPARE_CELLS:
        raise FitError(
            f"{len(cells)} trusted cells can't carry {len(terms.terms)} terms; choose a simpler formula or drive on."
        )
    least_squares = _LeastSquares.of(cells, terms)
    y = cells.values(target)
    coefficients = least_squares.coefficients(y)
    left = y - least_squares.columns @ coefficients
    share = cells.weight / cells.weight.sum()
    unexplained, total = float(share @ left**2), float(share @ (y - share @ y) ** 2)
    free = len(cells) - len(terms.terms)
    fold = _fold(cells)
    left_out = least_squares.left_out(left, fold)
    in_eta = as_efficiency(target, y - left_out, cells.omega, cells.torque) - cells.efficiency
    in_eta = np.where(np.isfinite(in_eta), in_eta, cells.efficiency)
    mean = float(np.mean(in_eta**2))
    by_fold = np.bincount(fold, in_eta**2, FOLDS) / np.maximum(np.bincount(fold, minlength=FOLDS), 1)
    by_fold = by_fold[np.bincount(fold, minlength=FOLDS) > 0]
    return PolynomialFit(
        target=target,
        terms=terms,
        coefficients=coefficients,
        sd=np.sqrt(np.diag(least_squares.spread()) * unexplained * cells.weight.sum() / free),
        r_squared=1.0 - unexplained / total if total > 0.0 else float("nan"),
        rmse=unexplained**0.5,
        cross_validated=float(np.sqrt(np.mean(left_out**2))),
        cross_validated_eta=mean**0.5,
        cross_validated_eta_sd=float(np.std(by_fold) / np.sqrt(len(by_fold)) / (2.0 * max(mean, 1e-300) ** 0.5)),
        cells=len(cells),
    )


def fit_classes(cells: Cells, target: Target, degree: int) -> tuple[PolynomialFit, ...]:
    """Fit every formula of a class that the cells can carry, the simplest first; raises `FitError` when none can be."""
    found = [fit(cells, target, terms) for terms in classes(degree) if len(cells) >= len(terms.terms) + SPARE_CELLS]
    if not found:
        raise FitError(f"{len(cells)} trusted cells can't carry any formula of degree {degree}. Drive on.")
    return tuple(found)


def best_of(fits: tuple[PolynomialFit, ...]) -> PolynomialFit:
    """Return the simplest formula whose cross-validated error in η is within one standard error of the least."""
    least = min(fits, key=lambda one: one.cross_validated_eta)
    bound = least.cross_validated_eta + least.cross_validated_eta_sd
    return min((one for one in fits if one.cross_validated_eta <= bound), key=lambda one: len(one.terms.terms))


def fit_chosen(cells: Cells, target: Target, words: tuple[str, ...]) -> PolynomialFit:
    """Fit the formula with the terms a person named; raises `FitError`."""
    return fit(cells, target, chosen_terms(words))


def as_efficiency(target: Target, value: FloatArray, omega: FloatArray, torque: FloatArray) -> FloatArray:
    """Turn a target's values into η; NaN where that has no meaning."""
    if target == "eta":
        return value
    with np.errstate(divide="ignore", invalid="ignore"):
        found = 1.0 / value if target == "phi" else omega * torque / value
    return np.where(value > 0.0, found, np.nan)


@dataclass(frozen=True, slots=True)
class _LeastSquares:
    """Normalised, centred columns in orthogonal form: root · (F − centre) / scale = q r, and ``back`` undoes it."""

    columns: FloatArray
    root: FloatArray
    q: FloatArray
    r: FloatArray
    back: FloatArray

    @staticmethod
    def of(cells: Cells, terms: TermSet) -> _LeastSquares:
        columns = terms.columns(cells.omega, cells.torque)
        constant = terms.terms.index((0, 0)) if (0, 0) in terms.terms else None
        share = cells.weight / cells.weight.sum()
        centre = share @ columns if constant is not None else np.zeros(columns.shape[1])
        scale = np.sqrt(share @ (columns - centre) ** 2)
        if constant is not None:
            centre[constant], scale[constant] = 0.0, 1.0
        root = np.sqrt(cells.weight)
        with np.errstate(divide="ignore", invalid="ignore"):
            q, r = np.linalg.qr(np.nan_to_num(root[:, None] * (columns - centre) / scale))
        if np.min(np.abs(np.diag(r))) < ALIKE * np.max(np.abs(np.diag(r))):
            raise FitError(
                "The cells lie so that some terms can't be told apart; choose a simpler formula or drive on."
            )
        back = np.diag(1.0 / scale)
        if constant is not None:
            back[constant] -= centre / scale
            back[constant, constant] = 1.0
        return _LeastSquares(columns, root, q, r, back)

    def coefficients(self, y: FloatArray) -> FloatArray:
        """Return the coefficients in original units, once refined."""
        first = self._solve(y)
        return first + self._solve(y - self.columns @ first)

    def _solve(self, y: FloatArray) -> FloatArray:
        return np.asarray(self.back @ np.linalg.solve(self.r, self.q.T @ (self.root * y)))

    def spread(self) -> FloatArray:
        """Return (FᵀWF)⁻¹ in original units."""
        root = self.back @ np.linalg.inv(self.r)
        return np.asarray(root @ root.T)

    def left_out(self, left: FloatArray, fold: IntArray) -> FloatArray:
        """Return each cell's error under the fit that leaves out its whole fold, without fitting anew."""
        errors = self.root * left
        for k in np.unique(fold):
            out = fold == k
            part = self.q[out]
            rest = np.eye(part.shape[1]) - part.T @ part
            errors[out] += part @ np.linalg.lstsq(rest, part.T @ errors[out], rcond=None)[0]
        return errors / self.root


def _fold(cells: Cells) -> IntArray:
    """Return which tenth each cell belongs to; neighbours stay together, else one would tell the other's value."""
    column = np.floor(cells.omega / (BLOCK_RPM * RADPS_PER_RPM)).astype(np.int64)
    row = np.floor(cells.torque / BLOCK_NM).astype(np.int64)
    return (3 * column + 7 * row + column * row) % FOLDS
