"""All formulas that are laid through one map side by side, and which of them is proposed (Sebesta 2010, 3.4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.engine.cells import HIGHEST_EFFICIENCY
from app.science.engine.efficiency_map import EfficiencyMap, Idle
from app.science.engine.fitting.basis import Basis
from app.science.engine.fitting.cells import (
    RADPS_PER_RPM,
    Cells,
    Target,
    trusted_cells,
    with_border,
    with_idle,
)
from app.science.engine.fitting.gaps import Gap, gaps
from app.science.engine.fitting.polynomial import FEWEST_CELLS, SPARE_CELLS, Formula, best_of, fit, fit_classes
from app.science.engine.fitting.shape import FuelShape, fuel_shape
from app.science.engine.fitting.surface import DrivenArea, Island, driven_area, peak_island
from app.science.engine.fitting.terms import DEGREES, FitError, TermSet, chosen_terms
from app.science.engine.fitting.willans import SIGNIFICANT, WILLANS, fit_willans

Remedy = Literal["none", "border", "cut", "drive"]
WORTH_SAYING = 0.01
FIRST = TermSet("first", ((0, 0), (1, 0), (0, 1), (1, 1)))
"""What tells how far P_in of the cells scatters, before idle is weighed against them."""


@dataclass(frozen=True, slots=True)
class FitRequest:
    """What is asked of a map.

    Attributes
    ----------
    target : {"eta", "phi", "p_in"}
    degree : int, optional
        Highest power of one variable; None for 2, 3 and 4.
    terms : tuple of str
        Own terms instead of a class, as `chosen_terms` reads them.
    remedy : {"none", "border", "cut", "drive"}
        Against empty regions: line the border with cells of no efficiency, cut off where η rises again when drawn, or
        drive there. The last two change no formula.
    weighted : bool
        Count a cell by how well its mean is known.
    """

    target: Target = "eta"
    degree: int | None = None
    terms: tuple[str, ...] = ()
    remedy: Remedy = "none"
    weighted: bool = False


@dataclass(frozen=True, slots=True)
class Fitted:
    """A formula and what it says of the engine.

    Attributes
    ----------
    formula : Formula
    peak : Island or None
        None when it gives no efficiency in the driven area.
    shape : FuelShape
    idle_fuel_power_w, idle_fuel_power_sd_w : float or None
        Fuel power without load at `MapFits.idle_rpm`; None for another target than P_in.
    non_convexity : float or None
        Of the Willans model, in standard errors.
    warnings : tuple of str
    """

    formula: Formula
    peak: Island | None
    shape: FuelShape
    idle_fuel_power_w: float | None
    idle_fuel_power_sd_w: float | None
    non_convexity: float | None
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MapFits:
    """The formulas asked for.

    Attributes
    ----------
    request : FitRequest
    efficiency_map : EfficiencyMap
    area : DrivenArea
    idle : Idle or None
        What P_in goes through, when the map tells of it.
    idle_rpm : float
    fits : tuple of Fitted
        Of the degree or with the terms asked for, the simplest first.
    proposed : Fitted
        Of those.
    best : Fitted
        Of all degrees; ``compared`` tells how many formulas that were.
    compared : int
    gaps : tuple of Gap
        Where to drive: the third remedy.
    """

    request: FitRequest
    efficiency_map: EfficiencyMap
    area: DrivenArea
    idle: Idle | None
    idle_rpm: float
    fits: tuple[Fitted, ...]
    proposed: Fitted
    best: Fitted
    compared: int
    gaps: tuple[Gap, ...]

    def named(self, name: str) -> Fitted:
        """Return the formula of that name, or the proposed one for ``proposed``; raises `FitError`."""
        if name == "proposed":
            return self.proposed
        found = next((one for one in self.fits if one.formula.terms.name == name), None)
        if found is None:
            known = ", ".join(repr(one.formula.terms.name) for one in self.fits)
            raise FitError(f"There is no formula {name!r} here; there are 'proposed', {known}.")
        return found

    def why(self) -> str:
        """Return the reason of the proposal in words."""
        formula = self.proposed.formula
        error = 100.0 * formula.cross_validated_eta
        said = f"It misses cells that were left out by {error:.2f} points of efficiency"
        if len(self.fits) == 1:
            return f"{said}; nothing else was asked for."
        return f"{said}, and no simpler one of these {len(self.fits)} comes within a standard error of the best."


def fit_map(efficiency_map: EfficiencyMap, request: FitRequest) -> MapFits:
    """Fit everything that is asked for.

    Raises
    ------
    FitError
        When the map can't carry it, or the remedy doesn't suit the target; the message says what to do.
    """
    cells, idle = _cells(efficiency_map, request), efficiency_map.idle
    area = driven_area(efficiency_map)
    idle_rpm = idle.rpm if idle is not None else float(area.rpm[0])
    basis = Basis.of(cells)
    of_classes = _of_classes(cells, request, basis)
    if request.terms:
        asked = [fit(cells, request.target, chosen_terms(request.terms))]
    else:
        asked = [one for one in of_classes if request.degree in (None, one.terms.degree)]
    every = {one.terms: one for one in (*of_classes, *asked)}
    said = {terms: _said(one, area, idle_rpm, None) for terms, one in every.items()}
    if request.target == "p_in" and int(cells.judged.sum()) >= len(WILLANS.terms) + SPARE_CELLS:
        willans = fit_willans(cells, basis)
        said[WILLANS] = _said(willans.formula, area, idle_rpm, willans.non_convexity)
        asked += [] if request.terms else [willans.formula]
    shown = tuple(said[one.terms] for one in sorted(asked, key=lambda one: len(one.terms.terms)))
    compared = tuple(said.values())
    return MapFits(
        request=request,
        efficiency_map=efficiency_map,
        area=area,
        idle=idle if request.target == "p_in" else None,
        idle_rpm=idle_rpm,
        fits=shown,
        proposed=_best(shown),
        best=_best(compared),
        compared=len(compared),
        gaps=gaps(efficiency_map),
    )


def _cells(efficiency_map: EfficiencyMap, request: FitRequest) -> Cells:
    cells = trusted_cells(efficiency_map, fewest=FEWEST_CELLS, weighted=request.weighted)
    if request.remedy == "border":
        if request.target != "eta":
            raise FitError(
                "A border of no efficiency has no 1/η and no fuel power; choose the remedy 'cut', or fit η itself."
            )
        return with_border(cells)
    if request.target == "p_in" and efficiency_map.idle is not None:
        return with_idle(cells, efficiency_map.idle, fit(cells, "p_in", FIRST).rmse)
    return cells


def _of_classes(cells: Cells, request: FitRequest, basis: Basis) -> list[Formula]:
    """Fit the formulas of all degrees that the cells carry; why the degree asked for can't be fitted is raised."""
    found: list[Formula] = []
    wanted = request.degree if request.degree is not None else min(DEGREES)
    for degree in sorted({*DEGREES, wanted}):
        try:
            found += fit_classes(cells, request.target, degree, basis)
        except FitError:  # the other degrees are tried for comparison only
            if degree == wanted and not request.terms:
                raise
    return found


def _best(fits: tuple[Fitted, ...]) -> Fitted:
    best = best_of([one.formula for one in fits])
    return next(one for one in fits if one.formula is best)


def _said(formula: Formula, area: DrivenArea, idle_rpm: float, non_convexity: float | None) -> Fitted:
    """Return a formula with its best point, the course of its fuel power, and what is to be said of it."""
    shape = fuel_shape(formula, area)
    warnings = [*_of_shape(shape)]
    try:
        peak = peak_island(formula, area)
    except FitError as error:
        peak = None
        warnings.append(str(error))
    idle_w = idle_sd_w = None
    if formula.target == "p_in":
        omega = idle_rpm * RADPS_PER_RPM
        idle_w = float(formula.values(np.array([omega]), np.zeros(1))[0])
        idle_sd_w = formula.value_sd(omega, 0.0)
        if idle_w < 0.0:
            warnings.append(
                "Without load its fuel power is below zero, which no engine's is; it only holds under load."
            )
    if peak is not None and peak.efficiency > HIGHEST_EFFICIENCY:
        warnings.append(
            f"An efficiency of {100.0 * peak.efficiency:.0f} % is beyond any engine: check mass, drag, rolling "
            "resistance and injector flow in the car file."
        )
    if peak is not None and peak.at_the_edge:
        warnings.append("Its best point lies at the border of what was driven; the engine may be better beyond.")
    if non_convexity is not None and non_convexity > SIGNIFICANT:
        warnings.append(
            f"The cells bend the other way by {non_convexity:.0f} standard errors; the model holds the curve convex."
        )
    return Fitted(formula, peak, shape, idle_w, idle_sd_w, non_convexity, tuple(warnings))


def _of_shape(shape: FuelShape) -> list[str]:
    said = []
    if shape.falling > WORTH_SAYING:
        said.append(f"Fuel falls with torque in {100.0 * shape.falling:.0f} % of the driven area; no engine does that.")
    if shape.concave > WORTH_SAYING and shape.concave_below_nm is not None:
        said.append(
            f"Fuel power is concave in torque in {100.0 * shape.concave:.0f} % of the driven area, mostly below "
            f"{shape.concave_below_nm:.0f} Nm: by this formula pulse and glide beats a steady torque there."
        )
    return said
