"""Laboratory data of a cell or pack to everything an estimator needs to know: curve, circuit, capacity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.battery.capacity_test import CapacityTest, capacity_tests
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.identify import Identified, identify
from app.science.battery.open_circuit_fit import FittedCurve, fit_curve
from app.science.battery.open_circuit_polynomial import PolynomialFit, polynomial_of
from app.science.battery.record import BatteryRecord

FAST_SHARE = 0.5
"""Share of all resistance that is taken to be in series before anything is identified."""

FIRST_TIME_CONSTANT_S = 60.0


@dataclass(frozen=True, slots=True)
class Characterised:
    """A cell as laboratory data show it.

    Attributes
    ----------
    fitted : FittedCurve
    polynomial : PolynomialFit or None
    circuits : tuple of Identified
        One for each record.
    tests : tuple of CapacityTest
        Of the pack.
    series, parallel : int
    """

    fitted: FittedCurve
    polynomial: PolynomialFit | None
    circuits: tuple[Identified, ...]
    tests: tuple[CapacityTest, ...]
    series: int
    parallel: int

    @property
    def best(self) -> Identified:
        """The record's circuit that is known best as a whole."""
        return min(self.circuits, key=lambda one: float(np.sum(np.log(one.sds[:4] / one.values[:4]))))

    def configuration(self) -> dict[str, Any]:
        """Return a configuration for further data of this battery; its first state of charge is left open."""
        curve = self.fitted.curve if self.polynomial is None else self.polynomial.curve
        initial = {name: float(value) for name, value in zip(VALUES[:4], self.best.values[:4], strict=True)}
        initial["capacity_ah"] = self.fitted.capacity_ah
        made: dict[str, Any] = {"ocv": curve.document(), "initial": initial}
        if curve.coefficients:
            made["ocv_soc_range"] = list(curve.soc_range)
        return made | {"series": self.series, "parallel": self.parallel}


def characterise(
    records: Sequence[BatteryRecord],
    capacity_ah: float | None = None,
    series: int = 1,
    parallel: int = 1,
    limits_v: tuple[float, float] | None = None,
    degree: int | None = None,
    ends_soc: tuple[float, float] = (0.0, 1.0),
) -> Characterised:
    """Fit the open-circuit curve to all records together, then the circuit to each, and list measured capacities.

    Parameters
    ----------
    records : sequence of BatteryRecord
        Of the pack.
    capacity_ah, series, parallel, limits_v, ends_soc
        As `fit_curve` has them.
    degree : int, optional
        Of a polynomial in the place of the curve's table.

    Raises
    ------
    TooLittleData
        When the records don't tell a curve.
    """
    fitted = fit_curve(records, capacity_ah, series, parallel, limits_v, ends_soc=ends_soc)
    config = BatteryConfig(first_cell(fitted, series, parallel))
    pack_v = None if limits_v is None else (series * limits_v[0], series * limits_v[1])
    return Characterised(
        fitted=fitted,
        polynomial=None if degree is None else polynomial_of(fitted.curve, degree),
        circuits=tuple(identify(record, config, curve_sd_v=fitted.misfit_v) for record in records),
        tests=tuple(test for record in records for test in capacity_tests(record, pack_v)),
        series=series,
        parallel=parallel,
    )


def first_cell(fitted: FittedCurve, series: int = 1, parallel: int = 1) -> Cell:
    """Return a cell to begin an identification with; its state of charge is to be looked up from the first voltage."""
    resistance = max(float(np.median(fitted.resistance_ohm)), 1e-6)
    relaxed = (1.0 - FAST_SHARE) * resistance
    circuit = Circuit(fitted.capacity_ah, FAST_SHARE * resistance, FIRST_TIME_CONSTANT_S / relaxed, relaxed)
    return Cell(fitted.curve, circuit, float("nan"), series, parallel)
