"""The score stage: once for the same question, never at the trip's expense, and with the map it names."""

from __future__ import annotations

from typing import Any

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.eco import scoring
from app.jobs import service as jobs
from app.science.errors import ScienceError
from app.storage.keys import stage_key
from app.trips.models import Trip
from tests.eco.conftest import SCORED_PERCENT, TRIP_L, Judging, Ledger, judged
from tests.yards import silent


def test_a_scored_trip_keeps_its_headline_and_the_whole_story(ledger: Ledger) -> None:
    row = ledger.score(ledger.drive("86"))
    assert (row.score, row.score_sd, row.reason, row.map_version) == (86.0, 2.0, "", 1)
    assert row.fuel_l == pytest.approx(TRIP_L * SCORED_PERCENT / 100.0)
    assert row.saved_l == pytest.approx(0.14 * row.fuel_l)
    assert row.provenance["map_version"] == 1
    files = ledger.resources.blobs.keys(str(row.document_key).rpartition("/")[0])
    assert [file.rpartition("/")[2] for file in files] == ["score.json", "score.parquet"]


def test_the_same_question_is_not_answered_twice(ledger: Ledger, judged_by: Judging) -> None:
    trip_id = ledger.drive("86")
    first = ledger.score(trip_id)

    def never(*_given: Any) -> Any:
        pytest.fail("asked again")

    judged_by(never)
    assert ledger.score(trip_id).scored_at == first.scored_at


def test_a_new_map_is_another_question_and_the_old_answer_goes_later(ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    documents = [ledger.score(trip_id).document_key]
    for version in (2, 3):
        ledger.new_map(version)
        row = ledger.score(trip_id)
        assert row.map_version == version
        documents.append(row.document_key)
    assert [ledger.resources.blobs.exists(str(key)) for key in documents] == [False, True, True]


def test_a_trip_is_scored_without_a_map_and_again_with_the_first_one(ledger: Ledger) -> None:
    ledger.another_car("new")
    trip_id = ledger.drive("86")
    row = ledger.score(trip_id)
    assert (row.score, row.map_version, row.reason) == (86.0, None, "")
    assert row.provenance["map_key"] is None
    ledger.new_map(1)
    assert ledger.score(trip_id).map_version == 1


def test_a_trip_whose_observer_failed_is_not_compared(ledger: Ledger) -> None:
    assert ledger.score(ledger.drive("86", verdict="failed")).reason == scoring.OBSERVER_FAILED


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (ScienceError("The map has only 3 cells."), "The map has only 3 cells."),
        (FileNotFoundError(), scoring.UNREADABLE),
        (ZeroDivisionError("by zero"), scoring.FAULT.format(error="by zero")),
    ],
)
def test_what_goes_wrong_is_told_in_the_row(ledger: Ledger, judged_by: Judging, error: Exception, reason: str) -> None:
    def fail(*_given: Any) -> Any:
        raise error

    judged_by(fail)
    row = ledger.score(ledger.drive("86"))
    assert (row.score, row.reason) == (None, reason)


@pytest.mark.parametrize("stopped", [jobs.JobCancelled, jobs.LeaseLost])
def test_a_cancelled_stage_stops(ledger: Ledger, judged_by: Judging, stopped: type[Exception]) -> None:
    def stop(*_given: Any) -> Any:
        raise stopped

    judged_by(stop)
    with pytest.raises(stopped):
        ledger.score(ledger.drive("86"))


def test_a_result_that_was_replaced_meanwhile_is_not_kept(ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    store = scoring.score(ledger.resources, FLEET, trip_id, silent)

    def observe_again(session: Any) -> None:
        session.get_one(Trip, trip_id).observe_key = stage_key("observe", name="again")

    ledger.write(observe_again)
    ledger.write(store)
    with pytest.raises(AssertionError):
        ledger.kept(trip_id)


def test_a_deleted_trip_is_no_fault(ledger: Ledger) -> None:
    ledger.write(scoring.score(ledger.resources, FLEET, "0" * 32, silent))


def test_the_stand_in_adds_up() -> None:
    score = judged(86.0)
    assert sum(part.litres for part in score.parts) == pytest.approx(score.saved_l.value)
