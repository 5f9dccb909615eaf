"""Formulas through cells whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.fitting.polynomial import (
    FOLDS,
    TARGETS,
    Cells,
    _fold,
    best_of,
    fit,
    fit_chosen,
    fit_classes,
    trusted_cells,
)
from app.science.engine.fitting.surface import peak_island
from app.science.engine.fitting.terms import DEGREES, FitError, chosen_terms, classes

PHI = np.array([9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04])
TABLE_4_1 = next(one for one in classes(2) if one.name == "table 4.1")


def engine(noise: float = 0.0, seed: int = 1) -> EfficiencyMap:
    """The thesis' engine (Table 4.1) over most of its area, with noisy cells."""
    rng = np.random.default_rng(seed)
    rpm, nm = (a.ravel() for a in np.meshgrid(np.arange(1025.0, 5500.0, 50.0), np.arange(11.0, 100.0, 2.0)))
    inside = nm < 40.0 + 0.03 * (rpm - 1000.0)
    rpm, nm = rpm[inside], nm[inside]
    omega = rpm * np.pi / 30.0
    efficiency = 1.0 / (TABLE_4_1.columns(omega, nm) @ PHI) + noise * rng.standard_normal(len(rpm))
    line = np.unique(rpm)
    nothing = np.full(len(rpm), 0.01)
    full_load = np.minimum(40.0 + 0.03 * (line - 1000.0), 100.0)
    n = np.full(len(rpm), 40)
    return EfficiencyMap(CellGrid(), rpm, nm, n, efficiency, nothing, 84.0 / efficiency, line, full_load)


CELLS = trusted_cells(engine())


def test_a_formula_of_the_truths_own_kind_is_found_again() -> None:
    found = fit(CELLS, "phi", TABLE_4_1)
    np.testing.assert_allclose(found.coefficients, PHI, rtol=1e-9)
    assert found.r_squared == pytest.approx(1.0, abs=1e-12)
    assert found.cross_validated < 1e-9


@given(st.sampled_from(TARGETS), st.sampled_from([t for d in DEGREES for t in classes(d)]), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_every_class_reproduces_its_own_polynomials(target: str, terms, seed: int) -> None:
    rng = np.random.default_rng(seed)
    scale = np.abs(terms.columns(CELLS.omega, CELLS.torque)).max(axis=0)
    truth = rng.uniform(0.5, 1.5, len(scale)) / scale
    values = terms.columns(CELLS.omega, CELLS.torque) @ truth
    if target == "eta":
        own = replace(CELLS, efficiency=values)
    else:
        own = replace(CELLS, efficiency=1.0 / values if target == "phi" else CELLS.omega * CELLS.torque / values)
    found = fit(own, target, terms)  # type: ignore[arg-type]
    assert np.abs(found.values(CELLS.omega, CELLS.torque) / values - 1.0).max() < 1e-9
    assert found.r_squared > 0.99


def test_leaving_out_a_fold_is_what_fitting_without_it_says() -> None:
    noisy = trusted_cells(engine(0.01), weighted=True)
    fold, errors = _fold(noisy), []
    for k in range(FOLDS):
        kept, out = fold != k, fold == k
        part = Cells(*(getattr(noisy, name)[kept] for name in ("omega", "torque", "efficiency", "weight")))
        other = fit(part, "eta", TABLE_4_1)
        errors.append(noisy.efficiency[out] - other.values(noisy.omega[out], noisy.torque[out]))
    own = fit(noisy, "eta", TABLE_4_1)
    assert own.cross_validated == pytest.approx(np.sqrt(np.mean(np.concatenate(errors) ** 2)), rel=1e-6)


def test_uncertainty_covers_the_truth_as_often_as_it_says() -> None:
    inside = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        noisy = replace(CELLS, efficiency=1.0 / (1.0 / CELLS.efficiency + 0.05 * rng.standard_normal(len(CELLS))))
        found = fit(noisy, "phi", TABLE_4_1)
        inside.append(np.abs(found.coefficients - PHI) < 2.0 * found.sd)
    assert 0.90 < np.mean(inside) < 0.99


def test_the_simplest_good_formula_is_proposed() -> None:
    noisy = trusted_cells(engine(0.005))
    every = tuple(one for degree in DEGREES for one in fit_classes(noisy, "phi", degree))
    assert best_of(every).terms.name == "table 4.1"


def test_own_terms_are_read() -> None:
    assert chosen_terms(["1", "w", "T", "ω²T³", "wT^2"]).words() == ("1", "ω", "T", "ω²T³", "ωT²")
    assert fit_chosen(CELLS, "phi", ("1", "w", "T", "wT", "w2", "T2")).coefficients == pytest.approx(PHI, rel=1e-9)
    for wrong in ("x", "", "w0", "ww", "w2T2w", "2w", "-T"):
        with pytest.raises(FitError):
            chosen_terms([wrong])
    with pytest.raises(FitError, match="twice"):
        chosen_terms(["w", "ω"])


def test_too_little_is_refused_in_words() -> None:
    whole = engine()

    def part(keep):
        columns = {name: getattr(whole, name)[keep] for name in ("rpm", "nm", "n", "efficiency", "sd", "bsfc_gpkwh")}
        return replace(whole, **columns)

    with pytest.raises(FitError, match="3 trusted cells"):
        trusted_cells(part(np.arange(3)))
    with pytest.raises(FitError, match="one engine speed"):
        trusted_cells(part(whole.rpm == whole.rpm[100]))
    few = trusted_cells(part(np.arange(0, len(whole.rpm), len(whole.rpm) // 12)))
    with pytest.raises(FitError, match="can't carry 25 terms"):
        fit(few, "eta", classes(4)[-1])
    two_speeds = trusted_cells(part(np.isin(whole.rpm, np.unique(whole.rpm)[[10, 40]])))
    with pytest.raises(FitError, match="told apart"):
        fit(two_speeds, "eta", TABLE_4_1)
    with pytest.raises(FitError, match="not 5"):
        classes(5)


def test_the_peak_is_where_the_truth_has_it() -> None:
    found = peak_island(fit(CELLS, "phi", TABLE_4_1), engine())
    assert (found.rpm, found.nm) == (pytest.approx(3867.0, abs=50.0), pytest.approx(92.9, abs=2.0))
    assert found.efficiency == pytest.approx(0.3896, abs=1e-3)
    assert found.rpm_range[0] < 3867.0 < found.rpm_range[1]
    assert not found.at_the_edge or found.nm_range[1] > 97.0
