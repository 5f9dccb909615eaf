"""Identification of the road load, against cars whose truth is known."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from app.imports.elevation import read_elevation
from app.science.logger.decode import ImageDecoder
from app.science.observer.observe import observe
from app.science.roadload import pool
from app.science.roadload.evidence import RoadLoadEvidence, trip_evidence
from app.science.roadload.identify import RoadLoad, identify
from app.science.roadload.windows import Regime, RoadLoadWindows, windows
from app.science.vehicle.model import Vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation
from tests.science.roadload.made_up import CAR, engine_power_w, made_up, told

AREA_M2 = CAR.cd * CAR.frontal_area_m2


def of(vehicle: Vehicle, *trips: RoadLoadWindows) -> RoadLoad:
    evidences = [trip_evidence(trip, vehicle, "fuel") for trip in trips]
    return identify([one for one in evidences if one is not None], vehicle)


@pytest.mark.parametrize(("cd", "crr"), [(1.3, 0.7), (0.7, 1.3)])
def test_a_wrong_file_is_put_right_where_nothing_is_noisy(cd: float, crr: float) -> None:
    found = of(told(cd, crr), made_up())
    assert found.cd_area_m2.value == pytest.approx(AREA_M2, rel=0.003)
    assert found.crr.value == pytest.approx(CAR.crr, rel=0.01)
    assert found.cd_area_m2.identified
    assert found.crr.identified


def test_the_errors_are_as_large_as_they_are_said_to_be() -> None:
    found = [of(CAR, made_up(seed=seed, noise_mps2=0.05)) for seed in range(12)]
    drag = [(one.cd_area_m2.value - AREA_M2) / one.cd_area_sd_given_mass_m2 for one in found]
    rolling = [(one.crr.value - CAR.crr) / one.crr.sd for one in found]
    assert 0.4 < np.sqrt(np.mean(np.square(drag))) < 1.4
    assert 0.4 < np.sqrt(np.mean(np.square(rolling))) < 1.4


def test_more_trips_are_surer_than_one() -> None:
    trips = [made_up(300, seed=seed, noise_mps2=0.05) for seed in range(8)]
    one, all_of_them = of(CAR, trips[0]), of(CAR, *trips)
    assert all_of_them.crr.sd < 0.6 * one.crr.sd
    assert all_of_them.trips == 8
    assert all_of_them.driving_windows > 8 * one.driving_windows * 0.9


def test_coasting_tells_most_and_braking_while_coasting_is_seen_through() -> None:
    without, coasted = (of(told(1.2, 0.8), made_up(coasting=n, noise_mps2=0.03)) for n in (0, 200))
    assert coasted.crr.sd < without.crr.sd
    assert coasted.crr.value == pytest.approx(CAR.crr, rel=0.05)
    assert {of.source: of.share for of in coasted.crr.shares}["coasting"] > 0.3
    assert sum(of.share for of in coasted.crr.shares) == pytest.approx(1.0)
    assert coasted.coasting_windows == pytest.approx(133, abs=5)


def test_without_reported_torque_the_mass_stays_the_files() -> None:
    found = of(CAR, made_up(mass_kg=1.2 * CAR.mass_kg))
    assert found.mass_kg.value == CAR.mass_kg
    assert not found.mass_kg.identified
    assert any("mass" in reason for reason in found.reasons)


def test_reported_torque_tells_the_mass() -> None:
    heavy = made_up(mass_kg=1.2 * CAR.mass_kg)
    evidence = trip_evidence(heavy, CAR, "torque")
    assert evidence is not None
    found = identify([evidence], CAR)
    weight = 0.05**2 / (0.05**2 + (1.2 * 0.07) ** 2)
    assert found.mass_kg.value / CAR.mass_kg == pytest.approx(1.0 + 0.2 * weight, abs=0.005)
    assert found.crr.value == pytest.approx(CAR.crr, rel=0.02)


def test_the_efficiency_after_is_the_true_one() -> None:
    trip, file = made_up(), told(1.3, 0.7)
    found = of(file, trip).levels
    assert found is not None
    fuel = trip.fuel_power_w
    true = engine_power_w(trip.engine_speed_radps, fuel).sum() / fuel.sum()
    assert found.after == pytest.approx(true, rel=0.02)
    assert found.before > found.after + 0.005
    assert found.best is not None
    assert found.best.before > found.before
    assert len(found.by_load) > 5


def test_nothing_usable_says_so() -> None:
    trip = made_up(100)
    nothing = trip.where(trip.kind == Regime.OVERRUN)
    assert trip_evidence(nothing, CAR, "fuel") is None
    found = identify([], CAR)
    assert found.model is None
    assert found.crr.value == CAR.crr
    assert [of.share for of in found.crr.shares] == [1.0, 0.0, 0.0, 0.0, 0.0]
    assert "can't be told" in found.reasons[0]


def test_windows_that_all_brake_leave_the_file_alone() -> None:
    trip = made_up(400, coasting=400)
    braked = replace(trip, specific_force_mps2=trip.specific_force_mps2 - 3.0)
    found = of(CAR, *[braked] * 5)
    assert found.crr.value == pytest.approx(CAR.crr)
    assert found.crr.sd == pytest.approx(0.3 * CAR.crr, rel=0.01)
    assert found.coasting_windows == 0


def test_only_rolling_tells_the_road_by_itself() -> None:
    trip = made_up(1200, coasting=1200, noise_mps2=0.03)
    found = of(told(1.1, 0.9), trip)
    assert found.coasting_windows == pytest.approx(800, abs=5)
    assert found.crr.sd < 0.06 * CAR.crr
    assert abs(found.crr.value - CAR.crr) < 2.0 * found.crr.sd
    assert abs(found.cd_area_m2.value - AREA_M2) < 2.0 * found.cd_area_sd_given_mass_m2


def test_one_speed_is_warned_of() -> None:
    trip = made_up(3000)
    same = trip.where(np.abs(trip.speed_mps - 15.0) < 1.5)
    assert any("one speed" in warning for warning in of(CAR, same).warnings)


def test_evidence_comes_back_from_json() -> None:
    evidence = trip_evidence(made_up(400), CAR, "fuel")
    assert evidence is not None
    back = RoadLoadEvidence.from_dict(json.loads(json.dumps(evidence.to_dict())))
    assert identify([back], CAR) == identify([evidence], CAR)


def test_one_fuel_at_two_torques_does_not_mislead() -> None:
    """As some measured engines do: over a band of torque the fuel stays, or even falls."""
    trip = made_up(3000)
    road = CAR.drag_area_kgpm * trip.speed_squared_m2ps2 / CAR.mass_kg + CAR.crr * trip.normal_mps2
    torque = (trip.specific_force_mps2 + road) * CAR.mass_kg * trip.speed_mps / trip.engine_speed_radps
    folded = trip.engine_speed_radps * (80.0 + 2.5 * torque + 60.0 * np.sin(torque / 20.0))
    file = told(0.7, 1.3)
    found = of(file, replace(trip, fuel_power_w=folded).where(torque > 0.0))
    assert found.cd_area_m2.value == pytest.approx(AREA_M2, rel=0.01)
    assert found.crr.value == pytest.approx(CAR.crr, rel=0.03)


def test_many_trips_are_thinned_evenly(monkeypatch: pytest.MonkeyPatch) -> None:
    trips = [trip_evidence(made_up(300, seed=seed), CAR, "fuel") for seed in range(4)]
    told_by = [one for one in trips if one is not None]
    monkeypatch.setattr(pool, "MOST_WINDOWS", 600)
    kept = pool.pooled(told_by)
    assert np.bincount(kept.trip).tolist() == pytest.approx([len(one.kept) / 2 for one in told_by], abs=6)
    assert np.all(np.diff(kept.group) >= 0)


def test_a_virtual_hour_puts_the_files_drag_right() -> None:
    trip = simulate(Simulation(duration_s=3600.0, seed=204))
    (recording,) = ImageDecoder().trips([trip.image])
    true = trip.vehicle
    file = replace(true, cd=1.3 * true.cd, crr=0.7 * true.crr)
    observation = observe(recording, file, elevation=read_elevation(trip.elevation_csv))
    found = of(file, windows(observation, file, recording))
    assert found.cd_area_m2.value == pytest.approx(true.cd * true.frontal_area_m2, rel=0.05)
    assert abs(found.crr.value - true.crr) < 2.5 * found.crr.sd
    assert found.crr.sd < 0.08 * true.crr
