"""Formulas as documents: every number of them, and the engine of a drive problem."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from io import StringIO

import numpy as np
import pytest

from app.exports.formulas import engine_block, fits_csv, fits_document, unit_of
from app.science.engine.fitting.cells import TARGETS, Target
from app.science.engine.fitting.family import FitRequest, fit_map
from tests.science.engine.fitting.engines import IDLE, PHI, engine

TRUE = engine()


def test_a_document_holds_all_coefficients_and_is_json() -> None:
    fits = fit_map(TRUE, FitRequest("phi", 2))
    document = json.loads(json.dumps(fits_document(fits), allow_nan=False))
    (table,) = [one for one in document["fits"] if one["name"] == "table 4.1"]
    assert table["coefficients"] == pytest.approx(PHI, rel=1e-9)
    assert document["best"] == document["best_of_all"]["name"] == "table 4.1"
    assert [one["proposed"] for one in document["fits"]].count(True) == 1


def test_a_table_has_a_line_per_coefficient() -> None:
    fits = fit_map(TRUE, FitRequest("p_in", 2))
    rows = list(csv.DictReader(StringIO(fits_csv(fits).decode())))
    assert len(rows) == sum(len(one.formula.terms.terms) for one in fits.fits)
    willans = [row for row in rows if row["formula"] == "Willans"]
    assert [row["term"] for row in willans] == ["1", "ω", "ω²", "ωT", "ωT²"]
    assert float(willans[0]["coefficient"]) == fits.named("Willans").formula.coefficients[0]


def test_units_are_those_of_the_coefficients() -> None:
    assert [unit_of("eta", term) for term in ((0, 0), (1, 0), (0, 2))] == ["1", "s/rad", "1/Nm²"]
    assert [unit_of("p_in", term) for term in ((0, 0), (0, 1), (2, 1))] == ["W", "W/Nm", "W·s²/(rad²·Nm)"]


def test_the_engine_of_a_drive_problem_is_the_thesis_table() -> None:
    phi = fit_map(TRUE, FitRequest("phi", 2))
    block = engine_block(phi, fit_map(replace(TRUE, idle=IDLE), FitRequest("p_in", 2)))
    assert block["engine"]["phi"] == pytest.approx(PHI, rel=1e-9)
    assert block["engine"]["idle_fuel_power_w"] == 7000.0
    assert block["engine"]["speed_rpm"] == [1025.0, 5475.0]
    assert block["engine"]["torque_nm"] == [11.0, 99.0]
    assert len(block["engine"]["full_load"]) == len(TRUE.full_load_rpm)
    unmeasured = engine_block(phi, fit_map(TRUE, FitRequest("p_in", 2)))
    assert unmeasured["engine"]["idle_fuel_power_w"] >= 0.0
    assert "Idle was not measured" in unmeasured["warnings"][-1]


@pytest.mark.parametrize("target", TARGETS)
def test_a_map_of_one_efficiency_everywhere_is_still_json(target: Target) -> None:
    flat = replace(TRUE, efficiency=np.full(len(TRUE.rpm), 0.25))
    document = fits_document(fit_map(flat, FitRequest(target)))
    assert json.dumps(document, allow_nan=False)
