"""What is fitted side by side, which is proposed, and what is said of each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.engine.fitting.cells import TARGETS
from app.science.engine.fitting.family import FitRequest, fit_map
from app.science.engine.fitting.terms import DEGREES, FitError, classes
from tests.science.engine.fitting.engines import IDLE, PHI, TABLE_4_1, engine, part_of

NOISY = engine(0.005)
WITH_IDLE = replace(NOISY, idle=IDLE)


def test_the_truths_own_kind_is_proposed_among_all_degrees() -> None:
    found = fit_map(NOISY, FitRequest("phi"))
    assert (found.proposed.formula.terms.name, found.compared) == ("table 4.1", 11)
    assert found.best is found.proposed
    np.testing.assert_allclose(found.proposed.formula.coefficients, PHI, atol=4.0 * found.proposed.formula.sd.max())
    assert "standard error" in found.why()


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("degree", DEGREES)
def test_a_degree_shows_its_classes_and_knows_the_best_of_all(target: str, degree: int) -> None:
    found = fit_map(NOISY, FitRequest(target, degree))  # type: ignore[arg-type]
    names = [one.formula.terms.name for one in found.fits]
    assert set(names) - {"Willans"} == {one.name for one in classes(degree)}
    assert ("Willans" in names) == (target == "p_in")
    sizes = [len(one.formula.terms.terms) for one in found.fits]
    assert sizes == sorted(sizes)
    assert found.best.formula.cross_validated_eta <= found.proposed.formula.cross_validated_eta * 1.2


def test_fuel_power_goes_through_the_measured_idle() -> None:
    without, anchored = (fit_map(one, FitRequest("p_in", 2)) for one in (NOISY, WITH_IDLE))
    for one in anchored.fits:
        assert one.idle_fuel_power_w is not None
        assert one.idle_fuel_power_w == pytest.approx(7000.0, abs=2500.0)
    gap = {
        found.idle is None: abs((found.named("table 4.1").idle_fuel_power_w or 0.0) - 7000.0)
        for found in (without, anchored)
    }
    assert gap[False] < 0.5 * gap[True]
    assert fit_map(WITH_IDLE, FitRequest("phi", 2)).proposed.idle_fuel_power_w is None


def test_own_terms_stand_alone_and_are_compared_with_the_classes() -> None:
    found = fit_map(NOISY, FitRequest("phi", terms=("1", "w", "T", "wT", "w2", "T2")))
    (own,) = found.fits
    assert own is found.proposed
    assert own.formula.terms.name == "chosen"
    assert found.compared == 12
    assert own.formula.coefficients == pytest.approx(fit_map(NOISY, FitRequest("phi")).proposed.formula.coefficients)


def test_a_border_pulls_the_efficiency_to_nothing_and_is_not_judged() -> None:
    bordered = fit_map(NOISY, FitRequest("eta", 4, remedy="border")).fits[-1].formula
    free = fit_map(NOISY, FitRequest("eta", 4)).fits[-1].formula
    edge = np.array([1.25 * NOISY.rpm.max() * np.pi / 30.0]), np.array([61.0])
    assert abs(bordered.efficiency(*edge)[0]) < 0.02 < abs(free.efficiency(*edge)[0])
    assert bordered.cells == free.cells
    with pytest.raises(FitError, match="'cut'"):
        fit_map(NOISY, FitRequest("phi", 2, remedy="border"))


def test_what_a_formula_does_wrong_is_said() -> None:
    said = " ".join(fit_map(NOISY, FitRequest("phi", 2)).named("table 4.1").warnings)
    assert "concave in torque" in said
    high = part_of(NOISY, NOISY.nm < 60.0)
    assert "border of what was driven" in " ".join(fit_map(high, FitRequest("eta", 2)).proposed.warnings)
    absurd = fit_map(replace(NOISY, efficiency=2.0 * NOISY.efficiency), FitRequest("eta", 2)).proposed.warnings
    assert any("beyond any engine" in one and "injector flow" in one for one in absurd)


def test_what_the_map_does_not_carry_is_refused_in_words() -> None:
    few = part_of(NOISY, np.arange(0, len(NOISY.rpm), len(NOISY.rpm) // 12))
    assert fit_map(few, FitRequest("eta", 2)).compared < 11
    with pytest.raises(FitError, match="can't carry 9 terms"):
        fit_map(few, FitRequest("phi", 4, terms=()))
    with pytest.raises(FitError, match="one engine speed"):
        fit_map(part_of(NOISY, NOISY.rpm == NOISY.rpm[100]), FitRequest())
    with pytest.raises(FitError, match="not 5"):
        fit_map(NOISY, FitRequest(degree=5))
    with pytest.raises(FitError, match=r"'table 4\.1'"):
        fit_map(NOISY, FitRequest(degree=2)).named("figure 9.9")
    assert TABLE_4_1.name == fit_map(NOISY, FitRequest(degree=2)).named("table 4.1").formula.terms.name
