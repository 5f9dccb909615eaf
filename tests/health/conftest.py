"""A car with trips whose road load is kept, and a judge that reads their names instead of their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.exports.parquet import road_load_parquet
from app.health import assessing
from app.health.assessing import Told
from app.health.models import Alert
from app.science.health.result import CarHealth, HealthAlert, Trend, TripHealth
from app.science.roadload.windows import WINDOW_COLUMNS, WINDOW_SCALARS, RoadLoadWindows
from app.science.vehicle.model import Vehicle
from app.storage.keys import stage_key
from app.trips.keys import ROAD_LOAD, result_file
from app.trips.models import Trip
from app.webhooks import service as webhooks
from tests.yards import Yard, silent

FIRST = datetime(2026, 3, 1, 8, tzinfo=UTC)
NEEDED = 2
SOFT = 20.0
WINDOWS = RoadLoadWindows(
    **{name: np.ones(3, dtype=np.int8 if name in ("kind", "gear") else np.float64) for name in WINDOW_COLUMNS},
    **dict.fromkeys(WINDOW_SCALARS, 1.0),
)


def judge(told: Sequence[Told], _vehicle: Vehicle, usual_since: datetime | None) -> CarHealth:
    """Stand in for the science: trips called soft have a soft tyre, the first trips since the usual say what it is."""
    later = [trip for trip, _windows in told if usual_since is None or trip.began >= usual_since]
    trips = tuple(
        TripHealth(trip.trip_id, trip.name, trip.began.timestamp(), "watched" if trip in later else "before")
        for trip, _windows in told
    )
    if len(later) < NEEDED:
        return CarHealth(trips, (), (), "", 0.1, len(later), NEEDED, "Too few trips.")
    usual = "soft" in later[0].name
    changed = [("soft" in trip.name) != usual for trip in later]
    words = f"Rolling resistance {SOFT:.0f} % above its usual, since {sum(changed)} trips"
    alerts: tuple[HealthAlert, ...] = ()
    if any(changed):
        first, last = later[changed.index(True)], later[-1]
        cleared = None if changed[-1] else last.trip_id
        ids = (first.trip_id, first.trip_id, last.trip_id, cleared)
        alerts = (
            HealthAlert("rolling_resistance", *ids, sum(changed), SOFT, 4.0, "%", 0.97, "drag", words, "Check tyres."),
        )
    trend = Trend(
        quantity="rolling_resistance",
        title="Rolling resistance",
        unit="%",
        trip_ids=tuple(trip.trip_id for trip in later),
        names=tuple(trip.name for trip in later),
        started_at=tuple(trip.began.timestamp() for trip in later),
        estimate=tuple(SOFT * one for one in changed),
        sd=(4.0,) * len(later),
        usual=0.0,
        usual_sd=2.0,
        band=9.0,
        change_points=tuple(alert.since_trip_id for alert in alerts),
        words="Rolling resistance.",
    )
    return CarHealth(trips, (trend,), alerts, words if alerts else "As usual.", 0.1, NEEDED, NEEDED)


class Garage(Yard):
    """A fleet with a car whose trips are assessed by names."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.began = FIRST
        self.told: list[tuple[str, str]] = []

    def drive(self, name: str, *, kept: bool = True) -> str:
        """Make the next trip, as the observe stage would leave it."""
        trip_id = self.new_trip(name)

        def describe(session: Session) -> None:
            trip, car = session.get_one(Trip, trip_id), cars.config(session, self.car_id)
            trip.observe_key, trip.verdict = stage_key("observe", name=name), "healthy"
            trip.started_at, self.began = self.began, self.began + timedelta(days=1)
            trip.provenance = {"config_sha256": car.sha256, "load_kg": car.vehicle.load_kg}
            if kept:
                file = result_file(trip, trip.observe_key, ROAD_LOAD)
                self.resources.blobs.put(file, road_load_parquet(WINDOWS))

        self.write(describe)
        return trip_id

    def assess(self) -> None:
        """Do what the health stage does."""
        self.write(assessing.assess(self.resources, FLEET, self.car_id, silent))

    def alerts(self) -> list[Alert]:
        """Return the rows of all alerts, oldest first."""
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            return list(session.scalars(select(Alert).order_by(Alert.created_at)))


@pytest.fixture
def garage(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> Garage:
    """Return a fleet with a car that has no trips but one that was never observed."""
    garage = Garage(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    monkeypatch.setattr(assessing, "judge", judge)

    def hear(_session: Session, event: str, data: dict[str, Any]) -> None:
        garage.told.append((event, data["words"]))

    monkeypatch.setattr(webhooks, "publish", hear)
    return garage
