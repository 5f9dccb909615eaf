"""Least-squares formulas for η, φ = 1/η or P_in over the trusted cells of a map (Sebesta 2010, 3.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.fitting.basis import Basis
from app.science.engine.fitting.cells import FOLDS, Cells, Target, folds
from app.science.engine.fitting.terms import FitError, TermSet, classes

NO_DIFFERENCE = 1e-6
SPARE_CELLS = 5
FEWEST_CELLS = SPARE_CELLS + 1


@dataclass(frozen=True, slots=True)
class Formula:
    """A formula with its coefficients and how good it is.

    Attributes
    ----------
    target : {"eta", "phi", "p_in"}
    terms : TermSet
    coefficients : array, shape (terms,)
        In original units: ω in rad/s, T in Nm, P in W.
    covariance : array, shape (terms, terms)
        Of the coefficients, as if the cells' errors were independent; 0 for one that is held at a bound.
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
    covariance: FloatArray
    r_squared: float
    rmse: float
    cross_validated: float
    cross_validated_eta: float
    cross_validated_eta_sd: float
    cells: int

    @property
    def sd(self) -> FloatArray:
        """Standard deviations of the coefficients, shape (terms,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def values(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return the formula's target at these engine speeds (rad/s) and torques (Nm)."""
        return self.terms.combined(self.coefficients, omega, torque)

    def value_sd(self, omega: float, torque: float) -> float:
        """Return the standard deviation of the formula's target at a point, from that of the coefficients."""
        row = self.terms.columns(np.array([omega]), np.array([torque]))[0]
        return float(np.sqrt(max(row @ self.covariance @ row, 0.0)))

    def efficiency(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return η; NaN where the formula has no meaning, as for a fuel power that isn't positive."""
        return as_efficiency(self.target, self.values(omega, torque), omega, torque)

    def fuel_power_w(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return P_in, W; NaN where the formula has no meaning."""
        values = self.values(omega, torque)
        if self.target == "p_in":
            return values
        power = omega * torque
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(values > 0.0, power * values if self.target == "phi" else power / values, np.nan)


def fit(cells: Cells, target: Target, terms: TermSet, basis: Basis | None = None) -> Formula:
    """Fit one formula by weighted least squares on normalised, centred columns.

    Parameters
    ----------
    cells : Cells
    target : {"eta", "phi", "p_in"}
    terms : TermSet
    basis : Basis, optional
        Of the same cells, to be shared by several formulas.

    Raises
    ------
    FitError
        When the cells are fewer than the terms and `SPARE_CELLS` more, or don't tell the terms apart.
    """
    enough(cells, terms)
    if basis is None or not basis.holds(terms):
        basis = Basis.of(cells, terms)
    chosen = basis.chosen(terms)
    y = cells.values(target)
    coefficients = chosen.coefficients(y)
    left = chosen.left(y, coefficients)
    return judged(cells, target, terms, coefficients, chosen.spread(), left, chosen.left_out(left))


def enough(cells: Cells, terms: TermSet) -> None:
    """Raise `FitError` when there are too few cells to tell the terms and how well they fit."""
    count = int(cells.judged.sum())
    if count < len(terms.terms) + SPARE_CELLS:
        raise FitError(
            f"{count} trusted cells can't carry {len(terms.terms)} terms; choose a simpler formula or drive on."
        )


def judged(
    cells: Cells,
    target: Target,
    terms: TermSet,
    coefficients: FloatArray,
    spread: FloatArray,
    left: FloatArray,
    left_out: FloatArray,
) -> Formula:
    """Return the formula with what its errors say of it.

    Parameters
    ----------
    cells : Cells
    target, terms, coefficients
        As in `Formula`.
    spread : array, shape (terms, terms)
        Covariance of the coefficients for cells of weight 1 and unit variance.
    left, left_out : array, shape (n,)
        Errors over the cells, and those of the cells when their fold is left out, in the target's unit.
    """
    own = cells.judged
    y, share = cells.values(target)[own], cells.weight[own] / cells.weight[own].sum()
    unexplained, total = float(share @ left[own] ** 2), float(share @ (y - share @ y) ** 2)
    variance = unexplained * float(cells.weight[own].sum()) / (int(own.sum()) - len(terms.terms))
    found = as_efficiency(target, y - left_out[own], cells.omega[own], cells.torque[own])
    in_eta = np.where(np.isfinite(found), found, 0.0) - cells.efficiency[own]
    mean, fold = float(np.mean(in_eta**2)), folds(cells)[own]
    count = np.bincount(fold, minlength=FOLDS)
    by_fold = np.bincount(fold, in_eta**2, FOLDS)[count > 0] / count[count > 0]
    return Formula(
        target=target,
        terms=terms,
        coefficients=coefficients,
        covariance=spread * variance,
        r_squared=1.0 - unexplained / total if total > 0.0 else float("nan"),
        rmse=unexplained**0.5,
        cross_validated=float(np.sqrt(np.mean(left_out[own] ** 2))),
        cross_validated_eta=mean**0.5,
        cross_validated_eta_sd=float(np.std(by_fold) / np.sqrt(len(by_fold)) / (2.0 * max(mean, 1e-300) ** 0.5)),
        cells=int(own.sum()),
    )


def fit_classes(cells: Cells, target: Target, degree: int, basis: Basis | None = None) -> tuple[Formula, ...]:
    """Fit every formula of a class that the cells can carry, the simplest first; raises `FitError` when none can be."""
    basis = basis or Basis.of(cells)
    found = []
    refused: FitError | None = None
    for terms in classes(degree):
        try:
            found.append(fit(cells, target, terms, basis))
        except FitError as error:
            refused = refused or error
    if refused is not None and not found:
        raise refused
    return tuple(found)


def best_of(formulas: Sequence[Formula]) -> Formula:
    """Return the simplest formula whose cross-validated error in η is within one standard error of the least.

    Errors that differ by less than `NO_DIFFERENCE` count as the same, so that rounding doesn't decide on exact data.
    """
    least = min(formulas, key=lambda one: one.cross_validated_eta)
    bound = least.cross_validated_eta + max(least.cross_validated_eta_sd, NO_DIFFERENCE)
    return min((one for one in formulas if one.cross_validated_eta <= bound), key=lambda one: len(one.terms.terms))


def as_efficiency(target: Target, value: FloatArray, omega: FloatArray, torque: FloatArray) -> FloatArray:
    """Turn a target's values into η; NaN where that has no meaning."""
    if target == "eta":
        return value
    with np.errstate(divide="ignore", invalid="ignore"):
        found = 1.0 / value if target == "phi" else omega * torque / value
    return np.where(value > 0.0, found, np.nan)
