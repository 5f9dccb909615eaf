"""Formulas through cells whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.engine.fitting.basis import Basis
from app.science.engine.fitting.cells import FOLDS, TARGETS, Cells, Target, folds, with_border
from app.science.engine.fitting.polynomial import best_of, fit, fit_classes
from app.science.engine.fitting.surface import cut_off, driven_area, peak_island
from app.science.engine.fitting.terms import DEGREES, FitError, TermSet, chosen_terms, classes
from tests.science.engine.fitting.engines import CELLS, PHI, TABLE_4_1, engine, part_of, trusted_cells

EVERY_CLASS = [terms for degree in DEGREES for terms in classes(degree)]


def test_a_formula_of_the_truths_own_kind_is_found_again() -> None:
    found = fit(CELLS, "phi", TABLE_4_1)
    np.testing.assert_allclose(found.coefficients, PHI, rtol=1e-9)
    assert found.r_squared == pytest.approx(1.0, abs=1e-12)
    assert found.cross_validated < 1e-9


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("terms", EVERY_CLASS, ids=lambda terms: f"{terms.degree}, {terms.name}")
def test_every_class_reproduces_its_own_polynomials(target: Target, terms: TermSet) -> None:
    """1e-9 on data without noise, and R² of 0.99 and more when a hundredth of noise lies on them."""
    rng = np.random.default_rng(len(terms.terms))
    columns = terms.columns(CELLS.omega, CELLS.torque)
    truth = rng.uniform(0.5, 1.5, columns.shape[1]) / np.abs(columns).max(axis=0)
    values = columns @ truth
    exact = fit(with_values(target, values), target, terms)
    assert np.abs(exact.values(CELLS.omega, CELLS.torque) / values - 1.0).max() < 1e-9
    assert exact.r_squared == pytest.approx(1.0, abs=1e-12)
    noise = 0.05 * float(np.std(values)) * rng.standard_normal(len(values))
    noisy = fit(with_values(target, np.maximum(values + noise, 0.1 * values)), target, terms)
    assert noisy.r_squared > 0.99
    assert (np.abs(noisy.coefficients - truth) < 5.0 * noisy.sd).all()


def with_values(target: Target, values: FloatArray) -> Cells:
    """Return the cells with efficiencies that make these the target's values."""
    efficiency = {"eta": values, "phi": 1.0 / values, "p_in": CELLS.omega * CELLS.torque / values}
    return replace(CELLS, efficiency=efficiency[target])


def test_leaving_out_a_fold_is_what_fitting_without_it_says() -> None:
    noisy = trusted_cells(engine(0.01), weighted=True)
    fold, errors = folds(noisy), []
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


def test_rounding_does_not_decide_which_formula_of_exact_data_is_proposed() -> None:
    right, more = (one for one in fit_classes(CELLS, "phi", 2) if len(one.terms.terms) in (6, 9))
    luckier = replace(more, cross_validated_eta=1e-16, cross_validated_eta_sd=1e-18)
    assert best_of((replace(right, cross_validated_eta=2e-16), luckier)).terms.name == "table 4.1"


def test_own_terms_are_read() -> None:
    assert chosen_terms(["1", "w", "T", "ω²T³", "wT^2"]).words() == ("1", "ω", "T", "ω²T³", "ωT²")
    assert fit(CELLS, "phi", chosen_terms(["1", "w", "T", "wT", "w2", "T2"])).coefficients == pytest.approx(
        PHI, rel=1e-9
    )
    for wrong in ("x", "", "w0", "ww", "w2T2w", "2w", "-T"):
        with pytest.raises(FitError):
            chosen_terms([wrong])
    with pytest.raises(FitError, match="twice"):
        chosen_terms(["w", "ω"])


def test_too_little_is_refused_in_words() -> None:
    whole = engine()
    with pytest.raises(FitError, match="3 trusted cells"):
        trusted_cells(part_of(whole, np.arange(3)))
    with pytest.raises(FitError, match="one engine speed"):
        trusted_cells(part_of(whole, whole.rpm == whole.rpm[100]))
    few = trusted_cells(part_of(whole, np.arange(0, len(whole.rpm), len(whole.rpm) // 12)))
    with pytest.raises(FitError, match="can't carry 25 terms"):
        fit(few, "eta", classes(4)[-1])
    two_speeds = trusted_cells(part_of(whole, np.isin(whole.rpm, np.unique(whole.rpm)[[10, 40]])))
    with pytest.raises(FitError, match="told apart"):
        fit(two_speeds, "eta", TABLE_4_1)
    with pytest.raises(FitError, match="not 5"):
        classes(5)


def test_the_peak_is_where_the_truth_has_it() -> None:
    found = peak_island(fit(CELLS, "phi", TABLE_4_1), driven_area(engine()))
    assert (found.rpm, found.nm) == (pytest.approx(3867.0, abs=50.0), pytest.approx(92.9, abs=2.0))
    assert found.efficiency == pytest.approx(0.3896, abs=1e-3)
    assert found.rpm_range[0] < 3867.0 < found.rpm_range[1]
    assert not found.at_the_edge or found.nm_range[1] > 97.0


def test_remedies_tame_a_formula_outside_its_data() -> None:
    whole = engine(0.004, 3)
    wild = fit(trusted_cells(whole), "eta", classes(4)[-1])
    far = np.array([7500.0]) * np.pi / 30.0, np.array([95.0])
    peak = peak_island(wild, driven_area(whole))
    assert cut_off(wild, peak, *far)[0] <= max(peak.efficiency, 0.0)
    inside = CELLS.omega[::50], CELLS.torque[::50]
    near_peak = np.abs(CELLS.torque[::50] - peak.nm) < 20.0
    assert cut_off(wild, peak, *inside)[near_peak] == pytest.approx(wild.efficiency(*inside)[near_peak], abs=0.02)
    bordered = fit(with_border(trusted_cells(whole)), "eta", classes(4)[-1])
    edge = np.array([1.25 * CELLS.omega.max()]), np.array([60.0])
    assert abs(bordered.efficiency(*edge)[0]) < 0.1 < abs(wild.efficiency(*edge)[0]) + 0.1


def test_sharing_the_factored_columns_changes_nothing() -> None:
    noisy = trusted_cells(engine(0.01), weighted=True)
    shared = Basis.of(noisy)
    for terms in (one for degree in DEGREES for one in classes(degree)):
        alone, together = fit(noisy, "phi", terms, Basis.of(noisy, terms)), fit(noisy, "phi", terms, shared)
        np.testing.assert_allclose(together.coefficients, alone.coefficients, rtol=1e-7)
        np.testing.assert_allclose(together.sd, alone.sd, rtol=1e-7)
        assert together.cross_validated_eta == pytest.approx(alone.cross_validated_eta, rel=1e-7)


def test_a_formula_is_what_least_squares_of_the_library_gives() -> None:
    noisy = trusted_cells(engine(0.01))
    for target in TARGETS:
        y, columns = noisy.values(target), TABLE_4_1.columns(noisy.omega, noisy.torque)
        plain, left, *_ = np.linalg.lstsq(columns, y, rcond=None)
        found = fit(noisy, target, TABLE_4_1)
        np.testing.assert_allclose(found.coefficients, plain, rtol=1e-7)
        assert found.rmse == pytest.approx(float(np.sqrt(left[0] / len(y))))
        spread = np.linalg.inv(columns.T @ columns) * left[0] / (len(y) - 6)
        np.testing.assert_allclose(found.covariance, spread, rtol=1e-5, atol=1e-12 * np.abs(spread).max())
