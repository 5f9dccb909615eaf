"""How batteries age: simulated histories, carried estimates, laboratory tests, and a real cell."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.science.battery.ageing import Ageing, HealthPoint, LabTest, ageing
from app.science.fields import ProblemError

YEAR = 365.25


def carried_history(seed: int, *, carried: bool, fading: float = 0.1) -> list[HealthPoint]:
    """Make 60 estimates over half a year, each a filter's that began with the one before."""
    rng, variance, points = np.random.default_rng(seed), 0.2**2, []
    mean = 0.2 * rng.standard_normal()
    for day in range(0, 180, 3):
        variance += 0.002**2 * 3.0 if day else 0.0
        gain = variance / (variance + 0.05**2)
        truth = np.log(1.0 - fading * day / YEAR)
        mean += gain * (truth + 0.05 * rng.standard_normal() - mean)
        variance *= 1.0 - gain
        value = float(np.exp(mean))
        points.append(HealthPoint(float(day), value, value * float(np.sqrt(variance)), charge_ah=2.0, carried=carried))
    return points


def covered(carried: bool) -> float:
    inside = []
    for seed in range(80):
        trend = ageing(carried_history(seed, carried=carried), rated_ah=1.0).capacity.trend
        assert trend is not None
        x = np.arange(0.0, 180.0, 3.0)
        inside.append(np.mean(np.abs(trend.at(x) - (1.0 - 0.1 * x / YEAR)) < 2.0 * trend.sd(x)))
    return float(np.mean(inside))


def test_estimates_that_took_over_from_one_another_are_not_counted_twice() -> None:
    assert covered(carried=True) >= 0.90
    assert covered(carried=False) < 0.80  # as if each were news: far too sure


def aged(threshold: float = 0.8, tests: tuple[LabTest, ...] = (), *, use_tests: bool = False) -> Ageing:
    rng = np.random.default_rng(8)
    at = np.linspace(0.0, 3.0 * YEAR, 150)
    points = [
        HealthPoint(
            float(day),
            float(33.1 * (1.0 - 0.04 * day / YEAR) + 0.2 * rng.standard_normal()),
            0.2,
            float(1e-3 * (1.0 + 0.1 * day / YEAR) + 1e-5 * rng.standard_normal()),
            1e-5,
            charge_ah=2.0 * 33.1,
            carried=False,
        )
        for day in at
    ]
    return ageing(points, threshold, tests, rated_ah=33.1, use_tests=use_tests)


def test_slopes_cycles_and_life_of_a_battery_that_fades_evenly() -> None:
    result = aged()
    document = result.document()
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    trend = document["capacity"]["trend"]
    assert trend["slope_share_per_year"] == pytest.approx(-0.04, abs=2.5 * trend["slope_share_per_year_sd"])
    assert trend["slope_share_per_year_sd"] < 0.002
    assert document["equivalent_full_cycles"] == pytest.approx(150.0)
    per_cycles = document["capacity"]["slope_share_per_100_cycles"]
    assert per_cycles == pytest.approx(-0.04 * 3.0 / 1.5, rel=0.1)
    left = document["capacity"]["remaining"]
    assert left["remaining_low_days"] < 2.0 * YEAR < (left["remaining_high_days"] or np.inf)
    assert left["remaining_days"] == pytest.approx(2.0 * YEAR, rel=0.1)
    grown = document["resistance"]["remaining"]
    assert grown["remaining_days"] == pytest.approx(7.0 * YEAR, rel=0.2)
    band = document["capacity"]["band"]
    assert len(band["at_days"]) == len(band["low"]) == len(band["high"])
    assert band["at_days"][-1] > 3.0 * YEAR
    assert not any("as far ahead" in warning for warning in result.warnings)
    assert any("times as far ahead" in warning for warning in aged(0.6).warnings)


def test_laboratory_tests_are_compared_and_used_when_asked() -> None:
    tests = (LabTest(YEAR, 33.1 * 0.96, 0.1), LabTest(2.0 * YEAR, 33.1 * 0.96, 0.1))
    result = aged(tests=tests)
    good, bad = result.tests
    assert good.sigmas is not None
    assert bad.sigmas is not None
    assert abs(good.sigmas) < 2.5
    assert bad.sigmas > 5.0
    assert any("1.3" in warning and "more than the estimates" in warning for warning in result.warnings)
    used = aged(tests=(LabTest(3.0 * YEAR + 30.0, 29.0, 0.01),), use_tests=True)
    assert used.used_tests
    assert used.capacity.points.value[-1] == 29.0


def test_too_little_history_tells_no_trend_and_says_so() -> None:
    for points in ([], [HealthPoint(0.0, 2.0, 0.05)], [HealthPoint(0.1 * k, 2.0, 0.05) for k in range(5)]):
        result = ageing(points)
        assert result.capacity.trend is None
        assert result.capacity.remaining is None
        assert "no trend yet" in result.warnings[0]
        json.dumps(result.document(), allow_nan=False)


def test_a_capacity_that_grows_is_doubted_and_a_threshold_in_percent_refused() -> None:
    points = [HealthPoint(10.0 * k, 2.0 + 0.01 * k, 0.005, carried=False) for k in range(20)]
    assert any("seems to grow" in warning for warning in ageing(points).warnings)
    with pytest.raises(ProblemError, match="threshold: 80 is no share"):
        ageing(points, 80.0)


days = st.one_of(st.floats(0.0, 5000.0), st.integers(0, 3).map(float))
capacities = st.floats(0.01, 100.0) | st.just(float("nan"))
deviations = st.floats(1e-9, 1e3) | st.sampled_from([0.0, float("nan"), float("inf")])
histories = st.lists(
    st.builds(HealthPoint, days, capacities, deviations, capacities, deviations, deviations, st.booleans()), max_size=9
)


@settings(max_examples=60)
@given(histories, st.lists(st.builds(LabTest, days, st.floats(0.01, 100.0), st.floats(1e-6, 10.0)), max_size=2))
def test_any_history_is_answered_in_finite_numbers(points: list[HealthPoint], tests: list[LabTest]) -> None:
    for use_tests in (False, True):
        json.dumps(ageing(points, 0.8, tests, use_tests=use_tests).document(), allow_nan=False)


def test_the_first_part_of_a_real_cells_life_foretells_the_rest(shared_data: Callable[[str], Path]) -> None:
    with (shared_data("nasa-b0018-aging") / "B0018_capacity.csv").open() as file:
        capacity = np.array([float(row["capacity_ahr"]) for row in csv.DictReader(file)])
    known = 79  # 60 % of 132 discharges
    points = [
        HealthPoint(float(k), capacity[k], 0.01, charge_ah=2.0 * capacity[k], carried=False) for k in range(known)
    ]
    result = ageing(points, 1.4 / 2.0, rated_ah=2.0)
    trend = result.capacity.trend
    assert trend is not None
    rest = np.arange(float(known), len(capacity))
    inside = np.abs(capacity[known:] - trend.at(rest)) < 2.0 * trend.sd(rest)
    assert np.mean(inside) >= 0.8
    measured = np.hypot(trend.sd(rest), 0.01 * trend.likeliest.scatter)
    assert np.mean(np.abs(capacity[known:] - trend.at(rest)) < 2.0 * measured) >= 0.9
    end = int(np.flatnonzero(capacity < 1.4)[0]) - (known - 1)
    left = result.capacity.remaining
    assert left is not None
    assert left.low is not None
    assert left.ahead is not None
    assert left.low < end < (left.high or np.inf)
    assert left.ahead == pytest.approx(end, rel=0.3)
    assert any("scatter" in warning for warning in result.warnings)
