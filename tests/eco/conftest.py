"""Cars with observed trips and maps, and a judge that reads the trips' names instead of their numbers."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from fastapi.testclient import TestClient
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.eco import repository, scoring
from app.eco.models import TripScoreRow
from app.eco.scoring import Question
from app.exports.parquet import columns_parquet
from app.jobs import service as jobs
from app.maps.models import MapVersion
from app.science.arrays import FloatArray
from app.science.eco.result import Acceleration, Along, CellLoss, Estimate, Loss, Section, Standing, TableRow, TripScore
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.trips.keys import STATES, result_file
from app.trips.models import Trip
from tests.yards import Yard, silent

FIRST = datetime(2026, 3, 1, 8, tzinfo=UTC)
TRIP_L = 2.5
SCORED_PERCENT = 80.0
ROWS = 21
BEGINS_S = 10.0


def along() -> Along:
    """Two stretches of road, driven faster than at their best."""
    distance = np.linspace(0.0, 1000.0, ROWS)
    same = {field: np.full(ROWS, 1.0) for field in Along.__dataclass_fields__}
    return Along(
        **same
        | {
            "distance_m": distance,
            "section": (distance > 500.0).astype(np.float64),
            "t_s": BEGINS_S + distance / 10.0,
            "speed_mps": np.full(ROWS, 10.0),
            "best_speed_mps": np.full(ROWS, 9.0),
            "gear": np.full(ROWS, 3.0),
            "best_gear": np.full(ROWS, 4.0),
            "best_costate": np.full(ROWS, np.nan),
        }
    )


def judged(score: float) -> TripScore:
    """What the science would say of a trip with this score."""
    share = 100.0 - score
    saved = TRIP_L * SCORED_PERCENT / 100.0 * share / 100.0
    parts = (
        Loss("braking", 1e6, 0.75 * saved, 0.75 * share),
        Loss("working_points", 1e6, 0.5 * saved, 0.5 * share),
        Loss("rest", -5e5, -0.25 * saved, -0.25 * share),
    )
    rise = Acceleration(1.0, 11.0, 0.0, 10.0, 10.0, 60.0, 0.0, "brisk, shifts at 3400 rpm", (3400.0,), 4e5)
    section = Section(0.0, 60.0, 0.0, 500.0, True, "", 1e6, 1e6, 1e6 * score / 100.0, 9e5, 59.0, 4, 3, "best found")
    return TripScore(
        score=Estimate(score, 2.0),
        saved_percent=Estimate(share, 2.0),
        saved_l=Estimate(saved, TRIP_L * SCORED_PERCENT / 100.0 * 0.02),
        driven_j=2e6,
        best_j=2e6 * score / 100.0,
        measured_j=2e6,
        trip_l=TRIP_L,
        scored_m=1000.0,
        scored_s=100.0,
        scored_percent=SCORED_PERCENT,
        doubts={"map": 2.0},
        parts=parts,
        cells=(CellLoss(2000.0, 40.0, 12.0, 0.01, 0.002), CellLoss(2050.0, 42.0, 8.0, 0.01, -0.001)),
        elsewhere=(),
        sections=(section, Section(70.0, 90.0, 500.0, 510.0, False, "Too short.", 1e4)),
        accelerations=(rise,),
        table=(TableRow("As driven", 400.0, None), TableRow("Best in the same time", 350.0, -12.5)),
        standing=Standing(1, 10.0, 1e4, 0.01),
        advice=("Shift up at 2500 rpm instead of 3400: 0.12 L",),
        assumptions=("Limits are the driven speeds' upper edge.",),
        warnings=(),
        along=along(),
    )


def judge(_blobs: Blobs, question: Question, progress: jobs.Progress) -> TripScore:
    """Stand in for the science: a trip's name is its score."""
    progress(0.5)
    return judged(float(question.trip.name.split()[0]))


class Ledger(Yard):
    """A fleet whose trips are scored by their names."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.began = FIRST

    def drive(self, name: str, *, verdict: str = "healthy") -> str:
        """Make the next trip, as the observe stage would leave it."""
        trip_id = self.new_trip(name)

        def describe(session: Session) -> None:
            trip = session.get_one(Trip, trip_id)
            trip.observe_key, trip.verdict = stage_key("observe", name=name), verdict
            trip.started_at, self.began = self.began, self.began + timedelta(days=1)
            states = {"t_s": np.array([0.0, 110.0]), "lat_deg": np.array([49.0, 49.1]), "lon_deg": np.array([8.0, 8.2])}
            self.resources.blobs.put(result_file(trip, trip.observe_key, STATES), columns_parquet(states))

        self.write(describe)
        return trip_id

    def measured(self, trip_id: str) -> dict[str, FloatArray]:
        """Give a trip the states that meters are made from: a steady drive."""
        steady = {"speed_mps": 10.0, "thrust_n": 300.0, "thrust_n_sd": 20.0, "pitch_rad": 0.0, "fuel_power_w": 1e4}
        steady |= {"gear": 3.0, "engine_speed_radps": 200.0}
        t = np.arange(0.0, 110.0)
        states = {"t_s": t} | {name: np.full(len(t), value) for name, value in steady.items()}

        def describe(session: Session) -> None:
            trip = session.get_one(Trip, trip_id)
            self.resources.blobs.put(result_file(trip, trip.observe_key or "", STATES), columns_parquet(states))

        self.write(describe)
        return states

    def another_car(self, name: str) -> str:
        """Drive another car from now on."""
        with self.resources.database.transaction(FLEET) as session:
            self.car_id = cars.create(session, name=name).id
        return self.car_id

    def new_map(self, version: int) -> None:
        """Give the car a map."""
        key = stage_key("map", car=self.car_id, version=version)
        numbers = dict.fromkeys(("cells", "trusted_cells", "points", "trips"), 1)
        row = MapVersion(car_id=self.car_id, version=version, key=key, provenance={}, document_key="none", **numbers)
        self.write(lambda session: session.add(row))

    def score(self, trip_id: str) -> TripScoreRow:
        """Do what the score stage does, and return what it kept."""
        self.write(scoring.score(self.resources, FLEET, trip_id, silent))
        return self.kept(trip_id)

    def kept(self, trip_id: str) -> TripScoreRow:
        """Return the row of a trip's score."""
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            row = repository.row(session, trip_id)
        assert row is not None
        return row


@pytest.fixture
def ledger(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> Ledger:
    """Return a fleet with a car that has a map."""
    ledger = Ledger(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    ledger.new_map(1)
    monkeypatch.setattr(scoring, "beside_the_best", judge)
    return ledger


Judging = Callable[[Callable[..., TripScore]], None]


@pytest.fixture
def judged_by(monkeypatch: pytest.MonkeyPatch) -> Judging:
    """Return a function that puts another judge in place."""
    return lambda judge: monkeypatch.setattr(scoring, "beside_the_best", judge)
