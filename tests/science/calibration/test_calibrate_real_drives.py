"""Calibration of real cars from their own drives."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from app.imports.combine import combine
from app.imports.signals import read_signals
from app.science.calibration.calibrate import Proposal, proposals, trip_evidence
from app.science.logger.recording import Recording
from app.science.observer.observe import observe
from app.science.vehicle.fields import apply_form
from app.science.vehicle.model import Vehicle
from app.science.vehicle.xml import read_vehicle

COMPACT = Vehicle(mass_wet_kg=1375.0, cd=0.30, frontal_area_m2=2.2, wheel_radius_m=0.316)


def one_trip(*paths: Path) -> Recording:
    return combine([read_signals(path.read_bytes(), filename=path.name) for path in paths])


def of_name(recording: Recording, vehicle: Vehicle, name: str) -> Proposal:
    return next(one for one in proposals([trip_evidence(recording, vehicle)], vehicle) if one.name == name)


def test_car_3ba1_tells_how_its_sensor_lies(shared_data) -> None:
    """x up, −y forward, as its publisher's data say; a few degrees askew, which its lateral bias confirms."""
    folder = shared_data("canedge-obd-imu-gnss")
    names = ("obd_events", "gnss_1hz", "imu_20hz")
    recording = one_trip(*(folder / f"car3BA1_00000165_{name}.csv.gz" for name in names))
    found = of_name(recording, COMPACT, "mounting")
    assert found.is_applicable
    assert "its −y axis points forward, its +z axis right and its −x axis down" in " ".join(found.evidence)
    back = read_vehicle(apply_form(b"<ponthy_config/>", found.form_values())).mounting
    axes = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
    assert np.degrees(np.arccos(np.clip((np.trace(axes.T @ back.matrix) - 1.0) / 2.0, -1.0, 1.0))) < 12.0
    seen = observe(recording, replace(COMPACT, mounting=back))
    assert seen.verdict == "healthy"
    assert abs(float(np.median(seen.columns["bias_j_mps2"]))) < 0.4


def test_comma2k19_speed_is_right_once_its_scale_is(shared_data) -> None:
    folder = shared_data("comma2k19-segment")
    names = ("imu_accel_104hz", "wheel_speed_83hz", "gnss_ublox_10hz")
    recording = one_trip(*(folder / f"{name}.csv" for name in names))
    vehicle = replace(COMPACT, mass_wet_kg=1600.0, cd=0.33, frontal_area_m2=2.6)
    found = of_name(recording, vehicle, "vss_m_per_tick")
    (change,) = found.changes
    assert change.field == "vss/calibration@speedScale"
    seen = observe(recording, replace(vehicle, speed_scale=change.after))
    reference = np.genfromtxt(folder / "truth_pose_20hz.csv", delimiter=",", names=True)
    true_speed = np.sqrt(sum(reference[name] ** 2 for name in ("ecef_vx", "ecef_vy", "ecef_vz")))
    inside = (reference["t_s"] > seen.columns["t_s"][0]) & (reference["t_s"] < seen.columns["t_s"][-1])
    speed = np.interp(reference["t_s"][inside], seen.columns["t_s"], seen.columns["speed_mps"])
    assert np.sqrt(np.mean((speed - true_speed[inside]) ** 2)) < 0.06
    assert of_name(recording, vehicle, "mounting").confidence == "weak"


def test_a_poll_every_seven_seconds_calibrates_no_speed(shared_data) -> None:
    folder = shared_data("canedge-obd-imu-gnss")
    recording = one_trip(folder / "car7512_obd_7s.csv", folder / "car7512_gnss_imu_5hz.csv.gz")
    assert not of_name(recording, COMPACT, "vss_m_per_tick").is_applicable
