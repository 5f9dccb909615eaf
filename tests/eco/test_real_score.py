"""A real score of a trip with the virtual car, through the stage that workers run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.exports.parquet import columns_parquet
from app.imports.elevation import read_elevation
from app.maps.models import MapVersion
from app.science.engine.cells import accumulate, build_map
from app.science.engine.document import map_document
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.logger.decode import ImageDecoder
from app.science.observer.observe import observe
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation
from app.settings import Settings
from app.storage.keys import stage_key
from app.storage.migrate import migrate
from app.trips.keys import STATES, result_file
from app.trips.models import Trip
from tests.eco.conftest import Ledger

TOLD = 1e-3
"""Numbers in the figures and tables are rounded; the parts add up as well as this, in litres."""


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Return settings of one size only: the science knows nothing of databases."""
    chosen = Settings(data_dir=tmp_path / "data")
    migrate(chosen)
    return chosen


@pytest.fixture
def driven(client: TestClient) -> Ledger:
    """Return a fleet whose car has driven three minutes in town, and its map."""
    ledger = Ledger(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    simulated = simulate(Simulation(duration_s=180.0, seed=7, route="town"))
    (recording,) = ImageDecoder().trips([simulated.image])
    observed = observe(recording, simulated.vehicle, elevation=read_elevation(simulated.elevation_csv))
    points = operating_points(observed, recording, simulated.vehicle)
    made = build_map(accumulate(points, CellGrid()), CellGrid(), simulated.vehicle)

    def describe(session: Session) -> None:
        ledger.car_id = cars.create(session, xml=simulated.car_xml, name="virtual").id
        trip = session.get_one(Trip, ledger.trip_id)
        trip.car_id, trip.observe_key, trip.verdict = ledger.car_id, stage_key("observe", name="town"), "healthy"
        ledger.resources.blobs.put(result_file(trip, trip.observe_key, STATES), columns_parquet(observed.columns))
        key = f"fleets/{FLEET}/maps/{ledger.car_id}/1.json"
        ledger.resources.blobs.put(key, json.dumps(map_document(made, {})).encode())
        numbers = dict.fromkeys(("cells", "trusted_cells", "points", "trips"), 1)
        row = MapVersion(car_id=ledger.car_id, version=1, key=key[:64], provenance={}, document_key=key, **numbers)
        session.add(row)

    ledger.write(describe)
    return ledger


def test_a_driven_trip_gets_a_score_whose_parts_add_up(client: TestClient, driven: Ledger) -> None:
    row = driven.score(driven.trip_id)
    assert row.reason == ""
    said = client.get(f"/api/v1/trips/{driven.trip_id}/score").json()
    assert 50.0 < said["score"]["value"] < 100.0
    assert 0.0 < said["score"]["sd"] < 10.0
    assert said["score"]["value"] + said["saved_percent"]["value"] == pytest.approx(100.0)
    assert sum(part["litres"] for part in said["parts"]) == pytest.approx(said["saved_l"]["value"], abs=TOLD)
    assert row.saved_l == pytest.approx(row.fuel_l * said["saved_percent"]["value"] / 100.0)
    for name in ("along", "parts", "cells", "accelerations", "place"):
        drawn = client.get(f"/api/v1/trips/{driven.trip_id}/figures/score-{name}").json()
        assert drawn["data"], name
    ranked = client.get("/api/v1/scores").json()["items"]
    assert [one["car_name"] for one in ranked] == ["virtual"]
    assert ranked[0]["score"] == pytest.approx(said["score"]["value"])
