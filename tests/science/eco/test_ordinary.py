"""The ordinary engine: seven measured ones fitted again, and a known one found from a trip's fuel alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.eco.ordinary import ENGINES, MISSED
from app.science.eco.result import TripScore
from app.science.eco.score import score_trip
from app.science.engine.fitting.willans import nonnegative_least_squares
from tests.science.eco.trips import CAR, driven, map_document

FILES = {
    "Geo 1.0 l petrol": ("geo_1.0L_SI_41kW", 1.0),
    "Insight 1.0 l petrol": ("insight_1.0L_VTEC-E", 1.0),
    "Prius 1.5 l petrol": ("prius_jpn_1.5L_43kW", 1.5),
    "Saturn 1.9 l petrol": ("saturn_1.9L_DOHC_95kW", 1.9),
    "Caravan 3.0 l petrol": ("caravan_3.0L_102kW", 3.0),
    "VW 1.9 l diesel": ("vw_1.9L_TDI_ORNL", 1.9),
    "Mercedes 1.7 l diesel": ("mercedes_1.7L_diesel_ORNL", 1.7),
}


@pytest.mark.parametrize("name", ENGINES)
def test_an_engine_is_what_its_measured_map_says(name: str, shared_data: Callable[[str], Path]) -> None:
    folder = shared_data("engine-maps-nrel")
    file, litres = FILES[name]
    heating = {one["id"]: one["fuel_lhv_J_g"] for one in json.loads((folder / "index.json").read_text())}
    cells = np.genfromtxt(folder / f"{file}.csv", delimiter=",", names=True)
    torque = cells["torque_nm"]
    used = (torque <= 1.001 * cells["max_torque_nm_at_rpm"]) & (torque > 0.1 * torque.max())
    used &= (cells["fuel_g_s"] > 0.0) & (cells["rpm"] > 900.0) & (cells["rpm"] < 4500.0)
    omega, tau = cells["rpm"][used] * np.pi / 30.0, torque[used] / litres
    power = cells["fuel_g_s"][used] * heating[file] / litres
    columns = np.stack((omega, omega**2, omega * tau, omega * tau**2), axis=1) / power[:, np.newaxis]
    size = np.sqrt(np.sum(columns**2, axis=0))
    found = nonnegative_least_squares(columns / size, np.ones(len(power))) / size
    assert ENGINES[name] == pytest.approx(found, rel=0.01, abs=5e-5)
    assert float(np.sqrt(np.mean((columns @ np.array(ENGINES[name]) - 1.0) ** 2))) < MISSED


@pytest.fixture(scope="module")
def trip() -> dict[str, FloatArray]:
    return driven(3600.0)


@pytest.fixture(scope="module")
def by_map(trip: dict[str, FloatArray]) -> TripScore:
    return score_trip(trip, CAR, map_document())


def test_a_trip_without_a_map_is_scored_by_its_own_fuel(trip: dict[str, FloatArray], by_map: TripScore) -> None:
    found = score_trip(trip, CAR, None)
    assert (found.engine, found.fuel_measured) == ("trip", True)
    assert found.driven_j == pytest.approx(found.measured_j, rel=0.03)
    assert abs(found.score.value - by_map.score.value) < 2.0 * found.score.sd
    assert by_map.score.sd < found.score.sd
    assert "too few cells" in found.warnings[0]


def test_a_trip_without_fuel_is_scored_by_an_ordinary_engine(trip: dict[str, FloatArray], by_map: TripScore) -> None:
    found = score_trip({**trip, "fuel_power_w": np.full_like(trip["t_s"], np.nan)}, CAR, None)
    assert (found.engine, found.fuel_measured) == ("ordinary", False)
    assert abs(found.score.value - by_map.score.value) < 2.0 * found.score.sd
    assert found.saved_l.sd / found.saved_l.value > found.saved_percent.sd / found.saved_percent.value
    assert "measured no fuel" in found.warnings[0]


def test_a_trip_without_fuel_is_charged_by_its_cars_map(trip: dict[str, FloatArray], by_map: TripScore) -> None:
    found = score_trip({**trip, "fuel_power_w": np.full_like(trip["t_s"], np.nan)}, CAR, map_document())
    assert (found.engine, found.fuel_measured) == ("map", False)
    assert found.score.value == pytest.approx(by_map.score.value, abs=2.0 * found.score.sd)
    assert "litres are those of the car's map" in found.warnings[0]
