"""Methods side by side: who is right by how much, who does not apply, and that work can be ended."""

from __future__ import annotations

import pytest

from app.science.optimal.methods.comparing import compare
from app.science.optimal.methods.found import MethodFailed
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import thesis


def test_rows_name_energy_error_and_verdict() -> None:
    # the thesis' case (Sebesta 2010, 4.4.2.1) in a given time; the errors are those of the grids
    shares: list[float] = []
    told = compare(read_problem(thesis(time_s=8.3)), ["pontryagin", "dp_speed"], shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert told.best == "pontryagin"
    exact, grid = told.rows
    assert (exact.verdict, exact.relative_error) == ("optimal", 0.0)
    assert grid.time_s == pytest.approx(8.3, rel=1e-12)
    assert 0.0 < grid.relative_error < 2e-5
    assert grid.verdict == "best found"
    row = told.document()["rows"][1]
    assert row["name"] == "dp_speed"
    assert row["milliseconds"] > 0.0


def test_a_method_that_does_not_apply_says_why() -> None:
    ball = {"kind": "ball_and_wheel", "x1": 1.0, "x2": 0.0, "u_min": -1.0, "u_max": 1.0, "gamma": 1.0}
    told = compare(read_problem(ball), ["dp_speed"])
    assert "accelerations" in told.rows[0].reason
    assert told.document()["rows"][0]["fuel_energy_j"] is None
    assert told.document()["best"] is None


def test_a_method_that_fails_says_what_it_met() -> None:
    row = compare(read_problem(thesis(time_s=4.0)), ["dp_speed"]).rows[0]
    assert "too short" in row.reason


def test_what_progress_raises_ends_the_work() -> None:
    class StopError(Exception):
        """Somebody has cancelled."""

    def stop(_share: float) -> None:
        raise StopError

    with pytest.raises(StopError):
        compare(read_problem(thesis()), ["dp_speed"], stop)


def test_an_unknown_name_is_refused_with_the_nearest() -> None:
    with pytest.raises(MethodFailed, match="did you mean dp_speed"):
        compare(read_problem(thesis()), ["dp_sped"])


def test_steps_of_time_leave_a_cvt_at_standstill_to_others() -> None:
    posed = read_problem(thesis(transmission={"type": "cvt"}, from_speed_mps=0.0))
    told = compare(posed, ["lqr", "direct_single_shooting", "dp_speed"])
    assert "no bound" in told.rows[0].reason
    assert "no bound" in told.rows[1].reason
    assert told.rows[2].verdict == "best found"
