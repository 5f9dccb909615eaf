"""The report's runs over REST: made by a job, kept, drawn, made again by another program."""

from __future__ import annotations

from typing import Any

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.batteries.reporting import ask_for_report
from app.science.battery import reproduce
from tests.batteries.conftest import Bench

pytestmark = pytest.mark.parametrize("settings", ["embedded"], indirect=True)
"""What the two databases differ in is tried where files come in."""


@pytest.fixture
def short_days(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the runs last some hours instead of a hundred days."""
    whole = reproduce.reproduce

    def short(**given: Any) -> Any:
        return whole(days=0.5, long_days=0.5, **given)

    monkeypatch.setattr(reproduce, "reproduce", short)


@pytest.mark.usefixtures("short_days")
def test_the_reports_runs_are_made_by_a_job_and_kept(bench: Bench) -> None:
    assert bench.ask("GET", "/report", 409)["code"] == "no-report"
    job = bench.ask("POST", "/report", 202)
    assert (job["kind"], job["battery_id"], job["car_id"]) == ("battery", None, None)
    assert bench.ask("POST", "/report", 202)["id"] == job["id"]
    assert bench.ask("GET", "/report", 409)["job_id"] == job["id"]
    assert bench.work(job["id"]) == "succeeded"
    runs = bench.ask("GET", "/report")
    assert [run["label"] for run in runs["short"]] == ["gpc, N = 2", "gpc, N = 3", "ekf_bias"]
    assert runs["provenance"]["code_version"] == bench.resources.settings.code_version
    for number in ("25", "26", "27", "28", "30", "31", "32", "33"):
        assert bench.ask("GET", f"/report/figures/{number}", params={"theme": "dark"})["data"], number
    bench.ask("GET", "/report/figures/29", 422)
    assert bench.ask("POST", "/report", 202)["id"] == job["id"]
    with bench.resources.database.transaction(FLEET) as session:
        again = ask_for_report(session, "another program")
    assert again.id != job["id"]
    assert bench.work(again.id) == "succeeded"
    assert bench.ask("GET", "/report")["job_id"] == again.id
