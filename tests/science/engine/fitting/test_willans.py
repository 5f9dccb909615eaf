"""A monotone, convex fuel model, found again and told when the data contradict it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from app.science.engine.fitting.cells import FOLDS, Cells, folds
from app.science.engine.fitting.willans import SIGNIFICANT, WILLANS, fit_willans, nonnegative_least_squares
from tests.science.engine.fitting.engines import CELLS, engine, trusted_cells

TRUTH = np.array([800.0, 4.0, 0.05, 2.3, 0.4])
ARRAYS = ("omega", "torque", "efficiency", "weight")


def part(cells: Cells, keep: np.ndarray) -> Cells:
    return Cells(*(getattr(cells, name)[keep] for name in ARRAYS))


def willans_engine(noise_w: float = 0.0) -> Cells:
    rng = np.random.default_rng(4)
    fuel = WILLANS.columns(CELLS.omega, CELLS.torque) @ TRUTH + noise_w * rng.standard_normal(len(CELLS))
    return replace(CELLS, efficiency=CELLS.omega * CELLS.torque / fuel)


@given(st.integers(0, 2**32 - 1), st.integers(6, 40))
@settings(max_examples=100, deadline=None)
def test_the_nonnegative_solution_is_that_of_the_library(seed: int, rows: int) -> None:
    rng = np.random.default_rng(seed)
    design, wanted = rng.normal(size=(rows, 5)), rng.normal(size=rows)
    theirs, _ = nnls(design, wanted)
    np.testing.assert_allclose(nonnegative_least_squares(design, wanted), theirs, atol=1e-10)


def test_a_model_is_found_again_and_is_convex() -> None:
    found = fit_willans(willans_engine())
    np.testing.assert_allclose(found.formula.coefficients, TRUTH, rtol=1e-6)
    assert found.non_convexity <= SIGNIFICANT
    assert found.formula.r_squared == pytest.approx(1.0, abs=1e-12)
    assert found.formula.values(np.array([90.0]), np.zeros(1))[0] == pytest.approx(800.0 + 360.0 + 405.0)


def test_its_deviations_say_how_far_it_is_from_the_truth() -> None:
    found = fit_willans(willans_engine(600.0)).formula
    assert (np.abs(found.coefficients - TRUTH) < 3.0 * found.sd).all()
    assert (found.sd < 0.5 * np.maximum(TRUTH, 100.0)).all()


def test_leaving_out_a_fold_is_what_fitting_without_it_says() -> None:
    noisy = trusted_cells(engine(0.01), weighted=True)
    fold, errors = folds(noisy), []
    for k in range(FOLDS):
        kept, out = part(noisy, fold != k), part(noisy, fold == k)
        other = fit_willans(kept).formula
        errors.append(out.values("p_in") - other.values(out.omega, out.torque))
    own = fit_willans(noisy).formula
    assert own.cross_validated == pytest.approx(np.sqrt(np.mean(np.concatenate(errors) ** 2)), rel=1e-6)


def test_the_thesis_engine_is_told_to_be_concave() -> None:
    """P_in = ωTφ of Table 4.1 is concave in T below about 63 Nm."""
    found = fit_willans(part(CELLS, CELLS.torque < 60.0))
    assert found.non_convexity > SIGNIFICANT
    torque = np.linspace(5.0, 55.0, 30)
    fuel = found.formula.values(np.full(30, 300.0), torque)
    assert (np.diff(fuel) > 0.0).all()
    assert (np.diff(fuel, 2) > -1e-6).all()
