"""The report's runs in small, and that nothing is lost when they are stored."""

from __future__ import annotations

import json

import numpy as np
import pytest

from app.science.battery.config import VALUES
from app.science.battery.report import ReportRuns
from app.science.battery.reproduce import reproduce


@pytest.fixture(scope="module")
def runs() -> ReportRuns:
    return reproduce(days=1.0, long_days=1.5)


def test_what_is_stored_comes_back(runs: ReportRuns) -> None:
    document = runs.document()
    stored = json.loads(json.dumps(document))
    assert stored == document
    assert ReportRuns.from_document(stored).document() == document


def test_each_figure_has_what_it_shows(runs: ReportRuns) -> None:
    assert runs.curve.columns["voltage_v"][[0, -1]] == pytest.approx([3.20, 3.34], abs=0.005)
    assert runs.pulses.columns["voltage_v"][0] == pytest.approx(runs.pulses.columns["voltage_v"][59])
    assert len(runs.drive.t_s) == 1369
    assert runs.drive.columns["current_a"].mean() < 0.0
    soc = runs.cycling.columns["soc"]
    assert (soc.min(), soc.max()) == pytest.approx((0.2, 0.8), abs=1e-3)
    assert runs.cycling.t_s[-1] == 36_000
    assert [run.label for run in runs.short] == ["gpc, N = 2", "gpc, N = 3", "ekf_bias"]
    assert [run.terms for run in runs.long] == [3, None]


def test_runs_begin_with_table_7_and_stay_there_until_they_are_switched_on(runs: ReportRuns) -> None:
    for run in runs.short:
        columns = run.history.columns
        off = run.history.t_s < run.start_after_s
        assert run.start_after_s == pytest.approx(8640, abs=1)
        for name, guess in zip(VALUES[:4], (2.2, 0.010, 3000.0, 0.010), strict=True):
            np.testing.assert_allclose(columns[name][off], guess, rtol=1e-6)
        assert columns["soc"][0] == 0.5
        assert columns["soc_true"][0] == 0.7
        assert columns["voltage_rms_v"][-1] < columns["voltage_rms_v"][5]


def test_capacity_fades_in_the_long_run_alone(runs: ReportRuns) -> None:
    fading = runs.long[0].history.columns["capacity_ah_true"]
    assert np.all(np.diff(fading) <= 0.0)
    assert 0.997 < fading[-1] / fading[0] < 1.0
    assert np.all(runs.short[0].history.columns["capacity_ah_true"] == 2.0)


def test_misses_are_the_last_estimates_against_the_truth(runs: ReportRuns) -> None:
    columns = runs.short[1].history.columns
    misses = runs.short[1].misses()
    assert misses["resistance_ohm"] == pytest.approx(columns["resistance_ohm"][-1] / 0.008 - 1.0)
    assert misses["soc"] == pytest.approx(columns["soc"][-1] - columns["soc_true"][-1])
