"""The observer on real cars: what their own references say of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.imports.combine import combine
from app.imports.signals import read_signals
from app.science.logger.recording import Recording
from app.science.observer.observe import observe
from app.science.vehicle.model import Mounting, Vehicle

COMPACT = Vehicle(mass_wet_kg=1375.0, cd=0.30, frontal_area_m2=2.2, wheel_radius_m=0.316)


def one_trip(*paths: Path) -> Recording:
    return combine([read_signals(path.read_bytes(), filename=path.name) for path in paths])


def test_comma2k19_minute_against_its_reference(shared_data) -> None:
    """The post-processed pose is independent; the car's own wheel speeds read 0.9 % low against it."""
    folder = shared_data("comma2k19-segment")
    names = ("imu_accel_104hz", "wheel_speed_83hz", "gnss_ublox_10hz")
    recording = one_trip(*(folder / f"{name}.csv" for name in names))
    reference = np.genfromtxt(folder / "truth_pose_20hz.csv", delimiter=",", names=True)
    true_speed = np.sqrt(sum(reference[name] ** 2 for name in ("ecef_vx", "ecef_vy", "ecef_vz")))
    vehicle = replace(COMPACT, mass_wet_kg=1600.0, cd=0.33, frontal_area_m2=2.6, mounting=Mounting())
    seen = observe(recording, vehicle)
    inside = (reference["t_s"] > seen.columns["t_s"][0]) & (reference["t_s"] < seen.columns["t_s"][-1])
    speed = np.interp(reference["t_s"][inside], seen.columns["t_s"], seen.columns["speed_mps"])
    error = speed - true_speed[inside]
    assert abs(error.mean()) < 0.20
    assert error.std() < 0.06
    assert seen.distance_m == pytest.approx(float(np.trapezoid(true_speed, reference["t_s"])), rel=0.012)
    assert seen.verdict == "healthy"


def test_a_gyroscope_sharpens_the_curvature(shared_data) -> None:
    folder = shared_data("comma2k19-segment")
    names = ("imu_accel_104hz", "wheel_speed_83hz", "gnss_ublox_10hz")
    without = one_trip(*(folder / f"{name}.csv" for name in names))
    recording = one_trip(*(folder / f"{name}.csv" for name in (*names, "imu_gyro_104hz")))
    vehicle = replace(COMPACT, mass_wet_kg=1600.0, mounting=Mounting())
    blunt, sharp = observe(without, vehicle), observe(recording, vehicle)
    assert next(s for s in sharp.sensors if s.sensor == "yaw_rate").count > 5000
    spread = [np.median(seen.columns["curvature_h_radpm_sd"]) for seen in (sharp, blunt)]
    assert spread[0] < 0.7 * spread[1]
    course = recording["heading_deg"]
    heading = np.interp(course.t_s, sharp.columns["t_s"], np.unwrap(sharp.columns["heading_rad"]))
    error = np.angle(np.exp(1j * (heading - np.radians(course.value))))
    assert np.degrees(np.std(error)) < 2.0


def test_car_3ba1_moves_as_its_receiver_says(shared_data) -> None:
    """Its sensor lies on its side: x up, y backwards."""
    folder = shared_data("canedge-obd-imu-gnss")
    recording = one_trip(
        *(folder / f"car3BA1_00000165_{name}.csv.gz" for name in ("obd_events", "gnss_1hz", "imu_20hz"))
    )
    upright = replace(COMPACT, mounting=Mounting(-np.pi / 2.0, np.pi / 2.0, 0.0))
    seen = observe(recording, upright)
    assert seen.verdict == "healthy"
    assert 43_000 < seen.distance_m < 44_000
    receiver = recording["gnss_speed_mps"]
    speed = np.interp(receiver.t_s, seen.columns["t_s"], seen.columns["speed_mps"])
    assert np.sqrt(np.mean((speed - receiver.value) ** 2)) < 0.3
    assert np.degrees(np.abs(seen.columns["pitch_rad"]).max()) < 8.0
    assert abs(float(np.median(seen.columns["bias_k_mps2"]))) < 0.5


def test_car_7512_fuel_and_both_distances(shared_data) -> None:
    """OBD speed every 7 s gives 26.7 km, the receiver 27.6 km: the observer, who hears both, says which to believe."""
    folder = shared_data("canedge-obd-imu-gnss")
    alone = read_signals((folder / "car7512_obd_7s.csv").read_bytes(), filename="car7512_obd_7s.csv")
    together = one_trip(folder / "car7512_obd_7s.csv", folder / "car7512_gnss_imu_5hz.csv.gz")
    vehicle = replace(COMPACT, mounting=Mounting(np.pi, 0.0, 0.0), fuel_energy_j_per_l=42.5e6 * 0.745)
    by_obd, by_both = observe(alone, vehicle), observe(together, vehicle)
    assert by_obd.distance_m == pytest.approx(26_680, rel=0.01)
    assert by_both.distance_m == pytest.approx(27_560, rel=0.01)
    for seen in (by_obd, by_both):
        assert seen.fuel_l == pytest.approx(1.17, abs=0.03)
        assert seen.verdict == "healthy"
    assert by_obd.warnings == alone.warnings
    said = by_both.warnings[-1]
    assert "26.7 km by the car's own speed" in said
    assert "27.6 km by the receiver" in said
    assert "every 7 s" in said
