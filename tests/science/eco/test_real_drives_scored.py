"""Two real drives whose maps carry no formula: scored nevertheless, with what that is worth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.imports.combine import combine
from app.imports.signals import read_signals
from app.science.arrays import FloatArray
from app.science.eco.score import score_trip
from app.science.observer.observe import observe
from app.science.vehicle.model import Mounting, Vehicle

COMPACT = Vehicle(mass_wet_kg=1375.0, cd=0.30, frontal_area_m2=2.2, wheel_radius_m=0.316)
"""A guess by the class of both cars, without gears and displacement."""
Drive = tuple[dict[str, FloatArray], Vehicle]


def states(folder: Path, names: tuple[str, ...], vehicle: Vehicle, seconds: tuple[float, float]) -> Drive:
    """Return some of a drive's states; the whole drives take longer than a test may."""
    recording = combine([read_signals((folder / name).read_bytes(), filename=name) for name in names])
    seen = observe(recording, vehicle).columns
    part = (seen["t_s"] >= seconds[0]) & (seen["t_s"] < seconds[1])
    return {name: values[part] for name, values in seen.items()}, vehicle


@pytest.fixture(scope="module")
def car_7512(shared_data: Callable[[str], Path]) -> Drive:
    names = ("car7512_obd_7s.csv", "car7512_gnss_imu_5hz.csv.gz")
    vehicle = replace(COMPACT, mounting=Mounting(np.pi, 0.0, 0.0), fuel_energy_j_per_l=42.5e6 * 0.745)
    return states(shared_data("canedge-obd-imu-gnss"), names, vehicle, (300.0, 912.0))


@pytest.fixture(scope="module")
def car_3ba1(shared_data: Callable[[str], Path]) -> Drive:
    names = tuple(f"car3BA1_00000165_{name}.csv.gz" for name in ("obd_events", "gnss_1hz", "imu_20hz"))
    vehicle = replace(COMPACT, mounting=Mounting(-np.pi / 2.0, np.pi / 2.0, 0.0))
    return states(shared_data("canedge-obd-imu-gnss"), names, vehicle, (1604.0, 1700.0))


def test_car_7512_is_scored_by_the_fuel_of_the_drive_itself(car_7512: Drive) -> None:
    found = score_trip(*car_7512, None)
    assert (found.engine, found.fuel_measured) == ("trip", True)
    assert 0.0 < found.saved_percent.value < 20.0
    assert 1.0 < found.saved_percent.sd < 10.0
    assert found.doubts["sections"] > 1.0
    assert found.driven_j == pytest.approx(found.measured_j, rel=0.12)
    assert found.warnings[0].startswith("The car's map has too few cells")


def test_car_3ba1_is_scored_by_an_ordinary_engine_in_the_gears_it_shows(car_3ba1: Drive) -> None:
    found = score_trip(*car_3ba1, None)
    assert (found.engine, found.fuel_measured) == ("ordinary", False)
    assert 5.0 < found.saved_percent.value < 50.0
    assert 2.0 < found.saved_percent.sd < 15.0
    assert max(found.doubts, key=lambda name: found.doubts[name]) == "engine_model"
    assert "measured no fuel" in found.warnings[0]
    assert any("the drive shows these" in line for line in found.warnings)
