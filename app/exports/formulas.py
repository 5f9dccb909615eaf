"""Formulas through a map as JSON, CSV, and as the engine of a drive problem."""

from __future__ import annotations

import csv
from dataclasses import asdict
from io import StringIO
from math import isfinite
from typing import Any

from app.science.engine.fitting.cells import Target
from app.science.engine.fitting.family import Fitted, MapFits
from app.science.engine.fitting.terms import Term
from app.science.engine.fitting.willans import WILLANS

TABLE_4_1 = ((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2))
"""The thesis' order of φ's coefficients: 1, ω, T, ωT, ω², T²."""
CSV_COLUMNS = ("formula", "target", "proposed", "term", "omega_power", "torque_power", "coefficient", "sd", "unit")


def fits_document(fits: MapFits) -> dict[str, Any]:
    """Return all formulas with their numbers as a JSON-able dict."""
    return {
        "target": fits.request.target,
        "degree": fits.request.degree,
        "remedy": fits.request.remedy,
        "weighted": fits.request.weighted,
        "cells": fits.proposed.formula.cells,
        "idle": None if fits.idle is None else asdict(fits.idle),
        "idle_rpm": fits.idle_rpm,
        "why": fits.why(),
        "best": fits.proposed.formula.terms.name,
        "best_of_all": {
            "name": fits.best.formula.terms.name,
            "degree": fits.best.formula.terms.degree,
            "cross_validated_eta": fits.best.formula.cross_validated_eta,
            "compared": fits.compared,
        },
        "fits": [_formula(one, proposed=one is fits.proposed) for one in fits.fits],
        "gaps": [asdict(gap) | {"words": gap.words()} for gap in fits.gaps],
    }


def _formula(one: Fitted, *, proposed: bool) -> dict[str, Any]:
    found = one.formula
    return {
        "name": found.terms.name,
        "proposed": proposed,
        "degree": found.terms.degree,
        "terms": [list(term) for term in found.terms.terms],
        "words": list(found.terms.words()),
        "units": [unit_of(found.target, term) for term in found.terms.terms],
        "coefficients": found.coefficients.tolist(),
        "sd": found.sd.tolist(),
        "r_squared": found.r_squared if isfinite(found.r_squared) else None,
        "rmse": found.rmse,
        "unit": "W" if found.target == "p_in" else "1",
        "cross_validated": found.cross_validated,
        "cross_validated_eta": found.cross_validated_eta,
        "cross_validated_eta_sd": found.cross_validated_eta_sd,
        "peak": None if one.peak is None else asdict(one.peak),
        "fuel": asdict(one.shape),
        "idle_fuel_power_w": one.idle_fuel_power_w,
        "idle_fuel_power_sd_w": one.idle_fuel_power_sd_w,
        "non_convexity": one.non_convexity,
        "warnings": list(one.warnings),
    }


def unit_of(target: Target, term: Term) -> str:
    """Return the unit of a term's coefficient, for ω in rad/s, T in Nm and P in W."""
    above = ["W"] if target == "p_in" else []
    above += [_raised("s", term[0])] if term[0] else []
    below = [_raised("rad", term[0])] if term[0] else []
    below += [_raised("Nm", term[1])] if term[1] else []
    if not below:
        return above[0] if above else "1"
    text = "·".join(below)
    return f"{'·'.join(above) or '1'}/{text if len(below) == 1 else f'({text})'}"


def _raised(unit: str, power: int) -> str:
    return unit if power == 1 else unit + str(power).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))


def fits_csv(fits: MapFits) -> bytes:
    """Write a line per coefficient of every formula."""
    text = StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for one in fits.fits:
        found, target = one.formula, fits.request.target
        rows = zip(found.terms.terms, found.terms.words(), found.coefficients.tolist(), found.sd.tolist(), strict=True)
        for term, word, coefficient, sd in rows:
            proposed = int(one is fits.proposed)
            writer.writerow(
                [found.terms.name, target, proposed, word, *term, repr(coefficient), repr(sd), unit_of(target, term)]
            )
    return text.getvalue().encode()


def engine_block(phi: MapFits, p_in: MapFits) -> dict[str, Any]:
    """Return the ``engine`` of a drive problem: φ by Table 4.1's terms, where it holds, full load and idle.

    Parameters
    ----------
    phi : MapFits
        Of φ, with the formula ``table 4.1``.
    p_in : MapFits
        Of the fuel power, with the Willans model, which says what the engine burns without load where idle was not
        measured.
    """
    table = phi.named("table 4.1")
    coefficients = dict(zip(table.formula.terms.terms, table.formula.coefficients.tolist(), strict=True))
    whole, warnings = phi.efficiency_map, list(table.warnings)
    line = [[float(a), float(b)] for a, b in zip(whole.full_load_rpm, whole.full_load_nm, strict=True)]
    if p_in.idle is not None:
        idle_w = p_in.idle.fuel_power_w
    else:
        idle_w = p_in.named(WILLANS.name).idle_fuel_power_w or 0.0
        warnings.append(
            f"Idle was not measured; {idle_w:.0f} W is the Willans model's fuel power without load at "
            f"{p_in.idle_rpm:.0f} rpm, the slowest that was driven."
        )
    return {
        "engine": {
            "phi": [coefficients[term] for term in TABLE_4_1],
            "speed_rpm": [float(phi.area.rpm[0]), float(phi.area.rpm[-1])],
            "torque_nm": [float(phi.area.nm[0]), float(phi.area.nm[-1])],
            "full_load": line or None,
            "idle_fuel_power_w": idle_w,
        },
        "fit": {
            "cells": table.formula.cells,
            "r_squared": table.formula.r_squared if isfinite(table.formula.r_squared) else None,
            "cross_validated_eta": table.formula.cross_validated_eta,
            "sd": [float(sd) for sd in table.formula.sd],
        },
        "warnings": warnings,
    }
