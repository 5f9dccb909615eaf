"""Full load and idle of a car's map follow the trips that count, whatever came and went in between."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.maps import service as maps
from app.maps.updating import update
from app.science.engine.idle import IdleSums
from app.trips import repository as trip_rows
from tests.science.engine.test_full_load import ceiling_nm
from tests.science.engine.test_full_load import drive as sweeps
from tests.synthetic import drive
from tests.yards import Yard, silent

LIMITS = ("full_load", "full_load_sd", "full_load_reached", "idle")


def document(yard: Yard) -> dict[str, Any]:
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        return maps.document(yard.resources.blobs, maps.version(session, yard.car_id, "latest"))


def change(yard: Yard, trip_id: str, **values: Any) -> None:
    def write(session: Any) -> None:
        trip = trip_rows.trip(session, trip_id)
        for name, value in values.items():
            setattr(trip, name, value)

    yard.write(write)


def test_limits_of_the_trips_that_count(yard: Yard) -> None:
    idle = IdleSums(30.0, 30.0 * 820.0, 30.0 * 820.0**2, 30.0 * 3200.0, 30.0 * 3200.0**2)
    floored = yard.observed("floored", drive(seconds=60.0), sweeps(np.ones(12)))
    change(yard, floored, summary={"idle": idle.to_dict()})
    first = document(yard)
    reached = np.array(first["full_load_reached"])
    rpm, nm = np.array(first["full_load"]).T
    assert reached.mean() > 0.9
    assert nm[reached] == pytest.approx(ceiling_nm(rpm[reached]), rel=0.04)
    assert first["idle"]["rpm"] == pytest.approx(820.0)
    assert first["idle"]["litres_per_hour"] == pytest.approx(3200.0 * 3600.0 / 32e6)

    gentle = yard.observed("gentle", drive(seconds=60.0), sweeps(np.linspace(0.2, 0.6, 9), seed=2))
    both = document(yard)
    change(yard, floored, in_map=False)
    without = document(yard)
    assert not any(without["full_load_reached"])
    assert without["idle"] is None
    change(yard, floored, in_map=True)
    assert [document(yard)[name] for name in LIMITS] == [both[name] for name in LIMITS]
    change(yard, gentle, in_map=False)
    assert [document(yard)[name] for name in LIMITS] == [first[name] for name in LIMITS]
