"""How a battery ages, from its history and laboratory tests; worked out on request, as it takes milliseconds."""

from __future__ import annotations

from datetime import datetime
from math import nan
from typing import Any

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.configuring import in_force
from app.batteries.models import Battery, BatteryEstimate, BatteryTest
from app.errors import PonthyError
from app.science.battery.ageing import HealthPoint, LabTest, ageing
from app.science.vehicle.battery import END_OF_LIFE

DAY_S = 86400.0
TEST_SD = 0.01
"""Share of a tested capacity by which it is taken to be uncertain when nobody said."""


def days(moment: datetime) -> float:
    """Return days since the beginning of 1970, UTC."""
    return moment.timestamp() / DAY_S


def ageing_document(
    session: Session, battery: Battery, threshold: float | None, *, use_tests: bool = False
) -> dict[str, Any]:
    """Return trends with bands, the remaining life down to a share of the rated capacity, and how tests compare.

    Times are days since the beginning of 1970, UTC; the car's file says the threshold where nobody does.
    """
    rated, end_of_life = rated_and_end(session, battery)
    points = [_point(estimate) for estimate in repository.history(session, battery.id)]
    tests = [_tested(test) for test in repository.all_tests(session, battery.id)]
    found = ageing(points, threshold or end_of_life, tests, rated_ah=rated, use_tests=use_tests)
    return found.document() | {"battery_id": battery.id}


def rated_and_end(session: Session, battery: Battery) -> tuple[float | None, float]:
    """Return the rated capacity of one cell and the share down to which it serves, as the car's file says them."""
    try:
        spec = in_force(session, battery.car_id).spec
    except PonthyError:  # taken out of the file: the history is still there to be looked at
        return None, END_OF_LIFE
    return spec.rated_capacity_ah or spec.capacity_ah, spec.end_of_life


def _point(estimate: BatteryEstimate) -> HealthPoint:
    numbers = (estimate.capacity_ah, estimate.capacity_ah_sd, estimate.resistance_ohm, estimate.resistance_ohm_sd)
    capacity, capacity_sd, resistance, resistance_sd = (nan if one is None else one for one in numbers)
    return HealthPoint(
        at=days(estimate.ended_at),
        capacity_ah=capacity,
        capacity_sd=capacity_sd,
        resistance_ohm=resistance,
        resistance_sd=resistance_sd,
        charge_ah=nan if estimate.charge_ah is None else estimate.charge_ah,
        carried=bool(estimate.provenance.get("carried_over")),
    )


def _tested(test: BatteryTest) -> LabTest:
    return LabTest(days(test.at), test.capacity_ah, test.capacity_ah_sd or TEST_SD * test.capacity_ah)
