"""The observe stage: states, verdict and provenance of a trip, kept until a better run replaces them."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.errors import PonthyError
from app.jobs import service as jobs
from app.roads import service as roads
from app.science.calibration import calibrate
from app.science.calibration.evidence import TripEvidence
from app.science.errors import TooLittleData
from app.science.observer.states import STATE_COLUMNS
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import DEFAULT_CAR, Simulation
from app.storage.resources import Resources
from app.trips import observing
from app.trips import service as trips
from app.trips.decoding import decode
from app.trips.keys import (
    EVIDENCE,
    INNOVATIONS,
    POINTS,
    ROAD_LOAD,
    ROAD_LOAD_EVIDENCE,
    STATES,
    result_file,
    results_folder,
)
from app.trips.models import LEFT_OUT, Trip
from app.trips.schemas import Observability, TripChange
from app.trips.stored import observability_of, observation_of, points_of, recording_of
from tests.yards import Yard, silent
from workers.running import StageWork, run_next_stage

BIAS = (0.12, -0.1, 0.15)
DRIVEN = simulate(Simulation(duration_s=150.0, seed=31, vehicle=DEFAULT_CAR, bias_mps2=BIAS))


@pytest.fixture
def yard(resources: Resources) -> Yard:
    """Return a fleet whose car is the virtual one and whose trip is decoded."""
    yard = Yard(resources)
    yard.write(lambda session: cars.replace_config(session, yard.car_id, DRIVEN.car_xml))
    yard.trip_id = yard.new_trip("drive", DRIVEN.image, "drive.dat")
    yard.write(decode(resources, FLEET, yard.trip_id, silent))
    return yard


def observed(yard: Yard, **options: Any) -> Trip:
    if options:
        yard.write(lambda session: setattr(session.get(Trip, yard.trip_id), "options", options))
    yard.write(observing.observe(yard.resources, FLEET, yard.trip_id, silent))
    return yard.trip()


def test_the_result_is_near_the_truth_and_says_where_it_is_from(yard: Yard) -> None:
    trip = observed(yard)
    assert trip.verdict == "healthy"
    assert trip.distance_m == pytest.approx(DRIVEN.summary["distance_m"], rel=0.005)
    assert trip.fuel_l == pytest.approx(DRIVEN.summary["fuel_l"], rel=0.02)
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        car = cars.config(session, yard.car_id)
    said = trip.provenance
    assert (said["input_sha256"], said["config_sha256"]) == (trip.input_sha256, car.sha256)
    assert (said["elevation_sha256s"], said["tuning"]["name"], said["smooth"]) == ([], "default", True)
    assert said["code_version"] == trip.code_version == yard.resources.settings.code_version
    assert set(trip.summary) >= {"events", "duration_s", "distance_m", "fuel_energy_j", "fuel_l", "nis", "timing_s"}


def test_what_is_stored_is_what_was_found(yard: Yard) -> None:
    trip = observed(yard)
    stored = observation_of(yard.resources.blobs, trip)
    assert stored.events == len(set(stored.innovations.t_s)) == trip.summary["events"]
    assert sum(sensor.count for sensor in stored.sensors) == len(stored.innovations.t_s)
    assert stored.columns["t_s"][-1] - stored.columns["t_s"][0] == pytest.approx(trip.duration_s)
    assert len(points_of(yard.resources.blobs, trip)) == trip.summary["operating_points"] > 100
    assert "injector_pulse_s" in recording_of(yard.resources.blobs, trip)


def test_the_same_run_is_not_done_twice(yard: Yard, monkeypatch: pytest.MonkeyPatch) -> None:
    before = observed(yard)

    def unexpected(*_: object, **__: object) -> None:
        pytest.fail("the observer ran although nothing has changed")

    monkeypatch.setattr(observing, "run_observer", unexpected)
    assert observed(yard).observe_key == before.observe_key


def test_another_tuning_car_or_road_is_another_run(yard: Yard) -> None:
    keys = [observed(yard).observe_key]
    keys.append(observed(yard, tuning="thesis-2010", smooth=False).observe_key)
    assert (yard.trip().tuning, yard.trip().smoothed) == ("thesis-2010", False)
    keys.append(observed(yard, tuning="default").observe_key)
    yard.write(lambda session: cars.change(session, yard.car_id, name=None, load_kg=250.0))
    keys.append(observed(yard).observe_key)
    yard.write(lambda s: roads.add_csv(s, yard.resources.blobs, name="road", data=DRIVEN.elevation_csv))
    with_road = observed(yard)
    keys.append(with_road.observe_key)
    assert len(with_road.provenance["elevation_sha256s"]) == 1
    assert any(row["sensor"].startswith("dem") for row in with_road.consistency)
    assert keys[0] == keys[2]
    assert len(set(keys)) == 4


def test_only_the_results_that_are_shown_and_those_being_made_are_kept(yard: Yard) -> None:
    for tuning in ("default", "thesis-2010", "default"):
        trip = observed(yard, tuning=tuning)
        files = yard.resources.blobs.keys(results_folder(trip))
        shown = {
            f"{results_folder(trip)}/{trip.observe_key}/{name}"
            for name in (STATES, POINTS, ROAD_LOAD, ROAD_LOAD_EVIDENCE, INNOVATIONS, EVIDENCE)
        }
        assert shown <= set(files)
        assert len(files) <= 14


def test_a_run_that_fails_leaves_what_was_there(yard: Yard) -> None:
    before = observed(yard)
    with pytest.raises(TooLittleData):
        observed(yard, without=["gps", "vss"])
    after = yard.trip()
    assert (after.observe_key, after.distance_m, after.verdict) == (before.observe_key, before.distance_m, "healthy")
    assert observation_of(yard.resources.blobs, after).distance_m == before.distance_m


def test_a_filter_that_diverges_says_when_and_leaves_what_was_there(yard: Yard) -> None:
    before = observed(yard)
    absurd = {"q_thrust": 1e300, "unsteady_boost": 1e10}
    yard.write(lambda session: setattr(session.get(Trip, yard.trip_id), "options", {"tuning": absurd}))
    job = yard.new_job()

    def stage(work: StageWork) -> jobs.Store:
        return observing.observe(yard.resources, FLEET, yard.trip_id, silent)

    run = {("trip", "decode"): lambda work: lambda session: None, ("trip", "observe"): stage}
    outcomes = [run_next_stage(yard.resources, FLEET, job.id, run) for _ in range(2)]
    assert outcomes[-1] == "failed"
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        view = trips.get(session, yard.trip_id)
    assert view.state == "failed"
    assert view.problem is not None
    assert view.problem["code"] == "estimator-diverged"
    assert 0.0 <= view.problem["t_s"] < 150.0
    assert f"at {view.problem['t_s']:.2f} s" in view.problem["detail"]
    assert (view.verdict, view.distance_m, view.tuning) == ("healthy", before.distance_m, "default")
    assert observation_of(yard.resources.blobs, yard.trip()).distance_m == before.distance_m


def test_a_run_cancelled_in_the_midst_stops_there_and_leaves_what_was_there(yard: Yard) -> None:
    before = observed(yard)
    yard.write(lambda session: setattr(session.get(Trip, yard.trip_id), "options", {"tuning": "thesis-2010"}))
    job, told = yard.new_job(), []

    def decoded(session: Session) -> None:
        held = jobs.claim(session, job.id, 30.0)
        assert held is not None
        jobs.finish(session, held)

    yard.write(decoded)

    def observe_and_cancel(work: StageWork) -> jobs.Store:
        def progress(fraction: float, detail: str | None = None) -> None:
            told.append(fraction)
            if len(told) == 4:
                yard.write(lambda session: jobs.cancel(session, job.id))
            with yard.resources.database.transaction(FLEET) as session:
                jobs.advance(session, work.claim, fraction, detail)

        return observing.observe(yard.resources, FLEET, yard.trip_id, progress)

    assert run_next_stage(yard.resources, FLEET, job.id, {("trip", "observe"): observe_and_cancel}) == "cancelled"
    assert len(told) == 4
    assert observing.READ < told[-1] < observing.OBSERVED
    assert yard.job(job.id).state == "cancelled"
    assert yard.trip().observe_key == before.observe_key


def test_a_trip_whose_observer_failed_is_left_out_of_the_map_once(yard: Yard, monkeypatch: pytest.MonkeyPatch) -> None:
    honest = observing.run_observer
    monkeypatch.setattr(observing, "run_observer", lambda *a, **k: replace(honest(*a, **k), verdict="failed"))
    trip = observed(yard)
    assert (trip.verdict, trip.in_map) == ("failed", False)
    assert LEFT_OUT in trip.warnings
    yard.write(lambda session: setattr(session.get(Trip, yard.trip_id), "in_map", True))
    assert observed(yard, smooth=False).in_map  # somebody took it in by hand


def test_a_trip_left_out_because_it_failed_comes_back_when_it_does_better(
    yard: Yard, monkeypatch: pytest.MonkeyPatch
) -> None:
    honest = observing.run_observer
    monkeypatch.setattr(observing, "run_observer", lambda *a, **k: replace(honest(*a, **k), verdict="failed"))
    observed(yard)
    assert observed(yard, smooth=False).is_left_out_by_itself
    monkeypatch.setattr(observing, "run_observer", honest)
    better = observed(yard, smooth=True)
    assert (better.in_map, LEFT_OUT in better.warnings) == (True, False)


def test_a_trip_left_out_by_hand_stays_out(yard: Yard, monkeypatch: pytest.MonkeyPatch) -> None:
    honest = observing.run_observer
    monkeypatch.setattr(observing, "run_observer", lambda *a, **k: replace(honest(*a, **k), verdict="failed"))
    observed(yard)
    for wanted in (True, False):
        yard.write(lambda s, wanted=wanted: trips.change(s, yard.trip_id, TripChange(in_map=wanted)))
    monkeypatch.setattr(observing, "run_observer", honest)
    assert not observed(yard, smooth=False).in_map


def test_a_trip_must_be_decoded_and_there(yard: Yard) -> None:
    with pytest.raises(PonthyError, match="has to be decoded"):
        observing.observe(yard.resources, FLEET, yard.new_trip("new"), silent)
    with pytest.raises(jobs.JobCancelled):
        observing.observe(yard.resources, FLEET, "0" * 32, silent)


def test_a_second_trip_starts_from_the_first_ones_biases_and_says_so(yard: Yard) -> None:
    first = observed(yard)
    assert first.provenance["bias_prior"] is None
    later = simulate(
        Simulation(
            duration_s=120.0, seed=32, vehicle=DEFAULT_CAR, bias_mps2=BIAS, started_at_utc_s=1256629260.0 + 86400.0
        )
    )
    first_id, yard.trip_id = yard.trip_id, yard.new_trip("later", later.image, "later.dat")
    yard.write(decode(yard.resources, FLEET, yard.trip_id, silent))
    second = observed(yard)
    prior = second.provenance["bias_prior"]
    assert prior["trips"] == [{"trip_id": first_id, "observe_key": first.observe_key}]
    assert prior["mean_mps2"] == pytest.approx(first.summary["final_bias_mps2"]["mean"])
    start = observation_of(yard.resources.blobs, second).columns["bias_k_mps2_sd"][0]
    assert start < 0.1
    alone = observed(yard, carry_over=False)
    assert alone.provenance["bias_prior"] is None
    assert alone.observe_key != second.observe_key


def test_what_a_trip_says_of_the_calibration_is_kept_and_never_costs_its_result(
    yard: Yard, monkeypatch: pytest.MonkeyPatch
) -> None:
    trip = observed(yard)
    kept = json.loads(yard.resources.blobs.get(result_file(trip, str(trip.observe_key), EVIDENCE)))
    assert TripEvidence.from_dict(kept).numbers["duration_s"] == pytest.approx(150.0, abs=1.0)

    def fault(*_: object) -> None:
        raise ZeroDivisionError("no ticks")

    monkeypatch.setattr(calibrate, "trip_evidence", fault)
    again = observed(yard, smooth=False)
    assert again.verdict == "healthy"
    assert [text for text in again.warnings if "calibration: no ticks" in text]
    assert not yard.resources.blobs.exists(result_file(again, str(again.observe_key), EVIDENCE))


def test_it_is_kept_what_the_sensors_tell(yard: Yard) -> None:
    found = Observability.model_validate(observability_of(yard.resources.blobs, observed(yard)))
    assert found.sensors == ["vss", "acc", "gps", "fuel", "engine"]
    assert [loss.lost for loss in found.losses] == [[], *([sensor] for sensor in found.sensors)]
    without = {tuple(loss.lost): loss for loss in found.losses}
    assert set(without[()].moving.values()) == {"always"}
    assert without[("acc",)].moving["bias_i_mps2"] == "never"
    assert not without[()].standing["thrust_n"]
    assert len(found.begin_s) == len(found.states["speed_mps"].sd) == 2
    assert list(found.states) == list(STATE_COLUMNS)
    assert found.states["speed_mps"].told_share == 1.0
    with pytest.raises(PonthyError, match="no result yet"):
        observability_of(yard.resources.blobs, yard.trip(yard.new_trip("new")))
