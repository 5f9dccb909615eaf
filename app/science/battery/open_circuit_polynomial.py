"""A polynomial in the place of a fitted open-circuit table, as the report has it (MAUTC-2010-02, fig. 25 b)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.battery.curve import OpenCircuit, voltage_at

SAMPLES = 801


@dataclass(frozen=True, slots=True)
class PolynomialFit:
    """A polynomial, and how far it is off.

    Attributes
    ----------
    curve : OpenCircuit
        Of the polynomial, over the states of charge it was fitted to.
    rms_v, worst_v : float
        How far it is off the table there: root mean square, and at most.
    falls : tuple of float or None
        Where it falls, which no open-circuit voltage does: between which states of charge.
    """

    curve: OpenCircuit
    rms_v: float
    worst_v: float
    falls: tuple[float, float] | None


def polynomial_of(curve: OpenCircuit, degree: int = 6, soc_range: tuple[float, float] = (0.1, 0.9)) -> PolynomialFit:
    """Fit a polynomial to a curve by least squares.

    Parameters
    ----------
    curve : OpenCircuit
    degree : int
        6 in the report.
    soc_range : tuple of float
        States of charge to fit it over; cut to where the curve is known. The report leaves out the steep ends.
    """
    low, high = max(soc_range[0], curve.soc_range[0]), min(soc_range[1], curve.soc_range[1])
    soc = np.linspace(low, high, SAMPLES)
    volts = voltage_at(curve.pieces, soc)
    fitted = np.polynomial.Polynomial.fit(soc, volts, degree).convert()
    made = OpenCircuit(tuple(float(one) for one in fitted.coef), soc_range=(low, high))
    off = voltage_at(made.pieces, soc) - volts
    return PolynomialFit(made, float(np.sqrt(np.mean(off**2))), float(np.abs(off).max()), made.falls())
