"""A car whose file says nothing of its accelerometer and too little of its wheels drives, and the file gets right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import calibration as calibrations
from app.cars import service as cars
from app.science.vehicle.fields import apply_form
from app.science.vehicle.model import Vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation
from app.storage.resources import Resources
from app.trips import observing
from app.trips.decoding import decode
from tests.yards import Yard, silent

ANGLES = [f"accelerometer/calibration/{name}" for name in ("roll@phi", "pitch@theta", "yaw@psi", "scale@scale")]
UNKNOWN = dict.fromkeys(ANGLES) | {"vss/calibration@metersPerTick": 0.265}
TRIP_S = 900.0
DAY_S = 86400.0


def driven() -> list[SimulatedTrip]:
    first = Simulation(duration_s=TRIP_S, seed=9601, bias_mps2=(0.1, -0.12, 0.08))
    trip = simulate(first)
    later = replace(first, seed=9602, vehicle=trip.vehicle, started_at_utc_s=first.started_at_utc_s + DAY_S)
    return [trip, simulate(later)]


def observe_all(yard: Yard, trip_ids: Sequence[str]) -> None:
    for trip_id in trip_ids:
        yard.write(observing.observe(yard.resources, FLEET, trip_id, silent))


def asked(yard: Yard) -> calibrations.Calibration:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        return calibrations.calibration(session, yard.resources.blobs, yard.car_id)


def turned_rad(one: Vehicle, other: Vehicle) -> float:
    between = replace(one.mounting, scale=1.0).matrix @ replace(other.mounting, scale=1.0).matrix.T
    return float(np.arccos(np.clip(0.5 * (np.trace(between) - 1.0), -1.0, 1.0)))


def test_what_the_trips_propose_makes_them_healthy(resources: Resources) -> None:
    yard, trips = Yard(resources), driven()
    xml = apply_form(trips[0].car_xml, UNKNOWN)
    yard.write(lambda session: cars.replace_config(session, yard.car_id, xml))
    ids = [yard.new_trip(f"drive {n}", trip.image, f"{n}.dat") for n, trip in enumerate(trips)]
    for trip_id in ids:
        yard.write(decode(resources, FLEET, trip_id, silent))
    observe_all(yard, ids)
    assert [(yard.trip(trip_id).verdict, yard.trip(trip_id).in_map) for trip_id in ids] == [("failed", False)] * 2

    found = asked(yard)
    names = [one.name for one in found.proposals if one.is_applicable]
    assert set(names) == {"mounting", "vss_m_per_tick"}
    yard.write(lambda session: calibrations.apply(session, resources.blobs, yard.car_id, names, found.key))
    observe_all(yard, ids)

    now, truth = asked(yard), trips[0].vehicle
    assert np.degrees(turned_rad(now.config.vehicle, truth)) < 1.0
    assert now.config.vehicle.vss_m_per_tick == pytest.approx(truth.vss_m_per_tick, rel=1e-3)
    assert [(yard.trip(trip_id).verdict, yard.trip(trip_id).in_map) for trip_id in ids] == [("healthy", True)] * 2
    assert not [one for one in now.proposals if one.is_applicable]
    prior = yard.trip(ids[1]).provenance["bias_prior"]
    assert [source["trip_id"] for source in prior["trips"]] == [ids[0]]
