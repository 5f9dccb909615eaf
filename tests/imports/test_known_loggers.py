"""Real drives of loggers that Ponthy knows, against what was measured on them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.imports.combine import combine
from app.imports.signals import SignalMapping, read_signals
from app.science.logger.recording import ACCELEROMETER, GYROSCOPE, Recording
from app.science.vehicle.xml import new_car_xml, read_vehicle

Finder = Callable[[str], Path]


def load(folder: Path, name: str, mapping: SignalMapping | None = None) -> Recording:
    return read_signals((folder / name).read_bytes(), filename=name, mapping=mapping)


def integral(recording: Recording, name: str) -> float:
    stream = recording[name]
    return float(np.trapezoid(stream.value, stream.t_s))


@pytest.fixture(scope="module")
def canedge(shared_data: Finder) -> Path:
    return shared_data("canedge-obd-imu-gnss")


@pytest.fixture(scope="module")
def comma(shared_data: Finder) -> Path:
    return shared_data("comma2k19-segment")


def test_car_7512_polled_obd(canedge: Path) -> None:
    obd = load(canedge, "car7512_obd_7s.csv")
    assert list(obd) == ["speed_mps", "engine_speed_rpm", "fuel_rate_lph", "engine_torque_nm"]
    assert obd.warnings == ()
    assert integral(obd, "speed_mps") == pytest.approx(26_680, abs=5)
    assert integral(obd, "fuel_rate_lph") / 3600 == pytest.approx(1.17, abs=0.002)
    assert obd["speed_mps"].t_s[0] == pytest.approx(3.89)
    assert obd["fuel_rate_lph"].t_s[0] == pytest.approx(7.49)
    assert obd["engine_torque_nm"].value.max() == pytest.approx(0.83 * 250.0)


def test_car_7512_has_a_plausible_brake_efficiency(canedge: Path) -> None:
    obd = load(canedge, "car7512_obd_7s.csv")
    fuel = obd["fuel_rate_lph"]
    torque_nm, rpm = (
        np.interp(fuel.t_s, obd[name].t_s, obd[name].value) for name in ("engine_torque_nm", "engine_speed_rpm")
    )
    loaded = (torque_nm > 15.0) & (fuel.value > 0.0)
    assert int(loaded.sum()) == pytest.approx(169, abs=2)
    mechanical_w = torque_nm[loaded] * rpm[loaded] * np.pi / 30.0
    efficiency = mechanical_w / (fuel.value[loaded] / 3600.0 * 0.745 * 42.5e6)
    np.testing.assert_allclose(np.percentile(efficiency, [25, 50, 75]), [0.295, 0.345, 0.392], atol=0.004)


def test_car_7512_receiver_and_sensors(canedge: Path) -> None:
    gnss = load(canedge, "car7512_gnss_imu_5hz.csv.gz")
    assert {*ACCELEROMETER, *GYROSCOPE, "lat_deg", "lon_deg", "alt_m", "gnss_speed_mps"} <= set(gnss)
    assert integral(gnss, "gnss_speed_mps") == pytest.approx(27_560, abs=5)
    assert gnss.started_at_utc_s == pytest.approx(1_725_694_989.6, abs=0.5)
    assert gnss["lat_deg"].t_s[0] > 60.0  # no fix before
    assert 55.9 < gnss["lat_deg"].value.min() < gnss["lat_deg"].value.max() < 56.2
    assert np.abs(gnss["gz_radps"].value).max() < 1.2  # rad/s: in degrees it would be 63
    assert np.median(gnss["az_mps2"].value) == pytest.approx(9.7, abs=0.1)


def test_car_7512_both_files_make_one_trip(canedge: Path) -> None:
    obd = load(canedge, "car7512_obd_7s.csv")
    gnss = load(canedge, "car7512_gnss_imu_5hz.csv.gz")
    trip = combine([obd, gnss])
    assert set(trip) == set(obd) | set(gnss)
    assert trip.warnings == ()
    assert trip.started_at_utc_s == gnss.started_at_utc_s
    t_s = trip["speed_mps"].t_s
    moving = (t_s > 120.0) & (t_s < 1880.0)
    gnss_speed = np.interp(t_s, trip["gnss_speed_mps"].t_s, trip["gnss_speed_mps"].value)
    difference = trip["speed_mps"].value[moving] - gnss_speed[moving]
    assert float(np.sqrt(np.mean(difference**2))) < 0.6  # one clock: OBD speed comes in whole km/h


def test_car_3ba1_receiver_starts_cold(canedge: Path) -> None:
    gnss = load(canedge, "car3BA1_00000165_gnss_1hz.csv.gz")
    assert gnss["lat_deg"].t_s[0] == pytest.approx(51.56)
    assert gnss["satellites"].t_s[0] == pytest.approx(17.09)
    assert gnss.started_at_utc_s == pytest.approx(1_627_305_212, abs=1.0)
    np.testing.assert_array_equal(gnss["lat_deg"].t_s, gnss["lon_deg"].t_s)


def test_car_3ba1_three_files_make_one_trip(canedge: Path) -> None:
    names = ("obd_events.csv.gz", "gnss_1hz.csv.gz", "imu_20hz.csv.gz")
    trip = combine([load(canedge, f"car3BA1_00000165_{name}") for name in names])
    assert len(trip["speed_mps"]) == 5699
    assert len(trip["ax_mps2"]) == 56_522
    assert float(np.mean(trip["ax_mps2"].value)) == pytest.approx(9.7, abs=0.1)  # mounted with x up
    t_s = trip["speed_mps"].t_s
    fixed = t_s > 60.0
    gnss_speed = np.interp(t_s[fixed], trip["gnss_speed_mps"].t_s, trip["gnss_speed_mps"].value)
    obd_speed = trip["speed_mps"].value[fixed]
    factor = float(obd_speed @ gnss_speed / (gnss_speed @ gnss_speed))
    assert factor == pytest.approx(1.011, abs=0.003)
    assert float(np.sqrt(np.mean((obd_speed - factor * gnss_speed) ** 2))) == pytest.approx(0.25, abs=0.1)
    assert trip.warnings[0].startswith("File 1: act_torque_pct needs “ref_torque_nm”")


def test_car_3ba1_torque_needs_its_reference(canedge: Path) -> None:
    mapping = SignalMapping.from_dict(
        {
            "signals": {"act_torque_pct": {"signal": "engine_torque_nm", "scale": 0.01, "times": "ref_torque_nm"}},
            "drop": ["*"],
            "constants": {"ref_torque_nm": 320.0},
        }
    )
    obd = load(canedge, "car3BA1_00000165_obd_events.csv.gz", mapping)
    assert len(obd["engine_torque_nm"]) == 5685
    assert 100.0 < obd["engine_torque_nm"].value.max() < 320.0


def test_comma2k19_minute_agrees_with_its_reference(comma: Path) -> None:
    names = (
        "imu_accel_104hz.csv",
        "imu_gyro_104hz.csv",
        "wheel_speed_83hz.csv",
        "gnss_ublox_10hz.csv",
        "can_decoded_events.csv.gz",
    )
    trip = combine([load(comma, name) for name in names])
    assert trip.warnings == ()
    assert {*ACCELEROMETER, *GYROSCOPE, "speed_mps", "lat_deg", "heading_deg", "engine_speed_rpm"} <= set(trip)
    truth = np.genfromtxt(comma / "truth_pose_20hz.csv", delimiter=",", names=True)
    true_speed = np.sqrt(truth["ecef_vx"] ** 2 + truth["ecef_vy"] ** 2 + truth["ecef_vz"] ** 2)
    wheel = np.interp(truth["t_s"], trip["speed_mps"].t_s, trip["speed_mps"].value)
    difference = (wheel - true_speed)[5:-5]
    assert float(np.std(difference)) < 0.052
    assert float(np.mean(difference)) == pytest.approx(-0.162, abs=0.005)  # its wheels are 1 % larger than it thinks
    assert np.median(trip["az_mps2"].value) == pytest.approx(-9.8, abs=0.2)  # forward, right, down
    assert trip["engine_speed_rpm"].value.max() == pytest.approx(2544, abs=1)
    assert trip.started_at_utc_s == pytest.approx(1_533_226_488.2, abs=0.2)


def test_comma2k19_phone_receiver(comma: Path) -> None:
    phone = load(comma, "gnss_phone_qcom.csv")
    assert len(phone["lat_deg"]) == 30
    assert phone["gnss_speed_mps"].value.max() == pytest.approx(20.45, abs=0.01)


def test_car_3ba1_sensor_is_turned_upright_by_the_cars_xml(canedge: Path) -> None:
    car = new_car_xml(
        {"accelerometer/calibration/roll@phi": "-90°", "accelerometer/calibration/pitch@theta": "90°"}
    )  # the sensor's x is up and its y backward
    imu = load(canedge, "car3BA1_00000165_imu_20hz.csv.gz")
    gnss = load(canedge, "car3BA1_00000165_gnss_1hz.csv.gz")
    body = read_vehicle(car).mounting.matrix @ np.array([imu[name].value for name in ACCELEROMETER])
    assert float(np.mean(body[2])) == pytest.approx(-9.7, abs=0.1)  # at rest, down reads −g
    speed = gnss["gnss_speed_mps"]
    middle = (speed.t_s[1:] + speed.t_s[:-1]) / 2.0
    kinematic = np.diff(speed.value) / np.diff(speed.t_s)
    forward = np.interp(middle, imu["ax_mps2"].t_s, np.convolve(body[0], np.full(20, 0.05), mode="same"))
    assert float(np.corrcoef(forward, kinematic)[0, 1]) == pytest.approx(0.84, abs=0.03)
