"""Trips in the fleet: what they add up to, what state they are in, what goes when one goes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.errors import Conflict, NotFound
from app.jobs import service as jobs
from app.science.errors import TuningError
from app.trips import service as trips
from app.trips.schemas import Reprocessing, TripChange, TripView
from tests.synthetic import drive, random_points
from tests.yards import Yard

OBSERVATION = drive(seconds=60.0)


def view(yard: Yard, trip_id: str) -> TripView:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        return trips.get(session, trip_id)


def test_the_state_follows_the_job(yard: Yard) -> None:
    job = yard.new_job()
    seen = [view(yard, yard.trip_id).state]
    for _ in range(4):
        claim = yard.claim(job.id)
        assert claim is not None
        seen.append(view(yard, yard.trip_id).state)
        with yard.resources.database.transaction(FLEET) as session:
            jobs.finish(session, claim)
    assert seen == ["waiting", "decoding", "observing", "mapping", "assessing"]
    assert view(yard, yard.trip_id).job_id == job.id


def test_a_failed_run_keeps_the_results_of_the_one_before(yard: Yard) -> None:
    trip_id = yard.observed("one", OBSERVATION, random_points(10))
    assert view(yard, trip_id).state == "ready"
    with yard.resources.database.transaction(FLEET) as session:
        job = trips.reprocess(
            session, trip_id, Reprocessing(filter="ukf", tuning="thesis-2010", smooth=False, without=["gps"])
        )
    claim = yard.claim(job.id)
    assert claim is not None
    with yard.resources.database.transaction(FLEET) as session:
        jobs.fail(session, claim, {"code": "estimator-diverged", "detail": "It diverged."})
    failed = view(yard, trip_id)
    assert (failed.state, failed.distance_m) == ("failed", OBSERVATION.distance_m)
    assert failed.problem == {"code": "estimator-diverged", "detail": "It diverged."}


def test_a_job_that_has_only_to_score_a_trip_gives_way(yard: Yard) -> None:
    trip_id = yard.observed("one", OBSERVATION, random_points(10))
    with yard.resources.database.transaction(FLEET) as session:
        first = trips.reprocess(session, trip_id, Reprocessing())
    for stage in jobs.TRIP_STAGES[:-1]:
        with pytest.raises(Conflict), yard.resources.database.transaction(FLEET) as session:
            trips.reprocess(session, trip_id, Reprocessing())
        claim = yard.claim(first.id)
        assert claim is not None
        assert claim.stage == stage
        with yard.resources.database.transaction(FLEET) as session:
            jobs.finish(session, claim)
    car_id = view(yard, trip_id).car_id
    with yard.resources.database.transaction(FLEET) as session:
        again = trips.reprocess(session, trip_id, Reprocessing())
        assert trip_id not in [job.trip_id for job in trips.reprocess_car(session, car_id)]
        assert jobs.get(session, first.id).state == "cancelled"
    assert (view(yard, trip_id).job_id, view(yard, trip_id).state) == (again.id, "waiting")


def test_a_cancelled_trip_says_so(yard: Yard) -> None:
    job = yard.new_job()
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, job.id)
    cancelled = view(yard, yard.trip_id)
    assert cancelled.state == "failed"
    assert cancelled.problem is not None
    assert cancelled.problem["code"] == "cancelled"


def test_a_trip_is_not_run_twice_at_once(yard: Yard) -> None:
    yard.new_job()
    with pytest.raises(Conflict), yard.resources.database.transaction(FLEET) as session:
        trips.reprocess(session, yard.trip_id, Reprocessing())
    with yard.resources.database.transaction(FLEET) as session:
        assert trips.reprocess_car(session, yard.car_id) == []


def test_an_impossible_tuning_is_refused_before_anything_runs(yard: Yard) -> None:
    for tuning in ("thesis-1810", {"q_thrust": -1.0}, {"warp": 9.0}):
        with pytest.raises(TuningError), yard.resources.database.transaction(FLEET) as session:
            trips.reprocess(session, yard.trip_id, Reprocessing(tuning=tuning))


def test_totals_count_fuel_only_where_it_is_known(yard: Yard) -> None:
    without_fuel = replace(OBSERVATION, distance_m=50_000.0, fuel_l=float("nan"), fuel_energy_j=float("nan"))
    yard.observed("a", replace(OBSERVATION, distance_m=100_000.0, fuel_l=6.0), random_points(1))
    trip = yard.observed("b", without_fuel, random_points(1))
    yard.write(lambda session: setattr(trips.row(session, trip), "fuel_l", None))
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        totals = trips.totals_of_cars(session, [yard.car_id, "f" * 32])
    mine = totals[yard.car_id]
    assert (mine.trip_count, mine.distance_m, mine.fuel_l) == (3, 150_000.0, 6.0)
    assert mine.litres_per_100km == pytest.approx(6.0)
    assert totals["f" * 32] == trips.CarTotals(0, 0.0, 0.0, None)


def test_leaving_a_trip_out_makes_one_map_job(yard: Yard) -> None:
    trip_id = yard.observed("one", OBSERVATION, random_points(10))
    with yard.resources.database.transaction(FLEET) as session:
        for in_map in (False, False, True):
            assert trips.change(session, trip_id, TripChange(in_map=in_map)).in_map is in_map
        made = jobs.page(session, state=None, trip_id=None, cursor=None, limit=10).items
    assert [(job.kind, job.car_id, job.trip_id) for job in made] == [("map", yard.car_id, None)]


def test_the_file_of_an_upload_goes_with_its_last_trip(yard: Yard) -> None:
    first, upload_id = yard.trip_id, yard.trip().upload_id
    with yard.resources.database.transaction(FLEET) as session:
        row = trips.row(session, first)
        second = type(row)(
            **{c.key: getattr(row, c.key) for c in row.__table__.columns if c.key not in ("id", "segment")}, segment=1
        )
        session.add(second)
        session.flush()
        second_id = second.id
    with yard.resources.database.transaction(FLEET) as session:
        assert trips.delete(session, first) is None
    with yard.resources.database.transaction(FLEET) as session:
        assert trips.delete(session, second_id) == upload_id
    with pytest.raises(NotFound):
        view(yard, first)


def test_files_of_removed_trips_are_swept(yard: Yard) -> None:
    kept = yard.observed("kept", OBSERVATION, random_points(1))
    gone = yard.observed("gone", OBSERVATION, random_points(1))
    upload_id = yard.trip(gone).upload_id
    yard.resources.blobs.put(f"fleets/{FLEET}/decoded/{upload_id}/key/0.parquet", b"x")
    with yard.resources.database.transaction(FLEET) as session:
        trips.delete(session, gone)
    assert trips.sweep(yard.resources, FLEET) == 2
    left = yard.resources.blobs.keys(f"fleets/{FLEET}")
    assert any(kept in key for key in left)
    assert not any(gone in key for key in left)
    assert not any("/decoded/" in key for key in left)
    assert trips.sweep(yard.resources, FLEET) == 0
