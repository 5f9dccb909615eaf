"""Reported torques that are wrong in a known way, and those of a real car."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from app.figures.theme import DARK
from app.figures.torque_sources import torque_sources_figure
from app.imports.combine import combine
from app.imports.signals import read_signals
from app.science.arrays import FloatArray
from app.science.engine.operating import DEFAULT_RULES
from app.science.engine.torque_sources import TorqueSources, torque_sources, words
from app.science.errors import ScienceError
from app.science.logger.recording import Recording, Series
from app.science.observer.observe import observe
from app.science.observer.result import Observation
from app.science.vehicle.model import Mounting, Vehicle
from tests.synthetic import drive

VEHICLE = Vehicle()


def reporting(seen: Observation, factor: float, extra_w: FloatArray | float = 0.0, late_s: float = 0.0) -> Recording:
    """What an engine reports every half second, its speed ``late_s`` after its torque."""
    c = seen.columns
    t = c["t_s"][::5]
    power = np.interp(t, c["t_s"], np.nan_to_num(c["power_w"]) * factor + extra_w)
    turning = np.interp(t, c["t_s"], c["engine_speed_radps"])
    fuel = np.interp(t, c["t_s"], c["fuel_power_w"]) * 3600.0 / VEHICLE.fuel_energy_j_per_l
    later = t + late_s
    return Recording(
        {
            "engine_torque_nm": Series(t, power / turning),
            "engine_speed_rpm": Series(later, np.interp(later, c["t_s"], c["engine_speed_radps"]) * 30.0 / pi),
            "fuel_rate_lph": Series(t, fuel),
        }
    )


def compared(seen: Observation, recording: Recording) -> TorqueSources:
    return torque_sources(seen, recording, VEHICLE, DEFAULT_RULES)


def test_a_torque_that_reads_high_is_told_from_other_reasons() -> None:
    seen = drive(seconds=900.0)
    found = compared(seen, reporting(seen, 1.08))
    assert found.work_ratio == pytest.approx(1.0 / 1.08, abs=0.003)
    losses, rolling, drag, mass = found.explanations
    assert losses.value == pytest.approx(0.08, abs=0.02)
    assert abs(rolling.value) < 0.002
    assert abs(drag.value) < 0.05
    assert abs(mass.value) < 0.02
    assert found.ages_s == {"engine_speed_rpm": 0.0, "fuel_rate_lph": 0.0}


def test_rolling_resistance_that_the_file_lacks_is_found_as_such() -> None:
    seen = drive(seconds=900.0)
    c = seen.columns
    rolling = 0.006 * VEHICLE.mass_kg * VEHICLE.gravity_mps2 * c["speed_mps"] * (c["power_w"] > 2000.0)
    found = compared(seen, reporting(seen, 1.0, rolling)).explanations
    assert found[1].value == pytest.approx(0.006, abs=0.002)
    assert abs(found[0].value) < 0.03
    assert found[1].power_w > sum(abs(other.power_w) for other in found[2:])


def test_signals_of_another_age_are_told() -> None:
    seen = drive(seconds=900.0)
    found = compared(seen, reporting(seen, 1.0, late_s=0.25))
    assert found.ages_s["engine_speed_rpm"] == pytest.approx(0.25)
    assert found.steady_rms_w < found.changing_rms_w
    assert any("engine speed 0.2 s" in text for text in words(found))


def test_too_few_moments_are_refused() -> None:
    seen = drive(seconds=12.0)
    with pytest.raises(ScienceError, match="it takes 20"):
        compared(seen, reporting(seen, 1.0))


def test_car_7512_by_both_torques(shared_data) -> None:
    """Engine speed is asked for 3 s away from torque; the observer is run without the torque, so the two are apart."""
    folder = shared_data("canedge-obd-imu-gnss")
    names = ("car7512_obd_7s.csv", "car7512_gnss_imu_5hz.csv.gz")
    recording = combine([read_signals((folder / name).read_bytes(), filename=name) for name in names])
    vehicle = Vehicle(
        mass_wet_kg=1375.0, cd=0.30, frontal_area_m2=2.2, wheel_radius_m=0.316, mounting=Mounting(pi, 0.0, 0.0),
        fuel_energy_j_per_l=42.5e6 * 0.745,
    )  # fmt: skip
    others = {name: series for name, series in recording.signals.items() if name != "engine_torque_nm"}
    found = torque_sources(observe(replace(recording, signals=others), vehicle), recording, vehicle, DEFAULT_RULES)
    assert len(found.t_s) == 141
    assert found.work_ratio == pytest.approx(0.89, abs=0.03)
    assert 0.015 < found.work_ratio_sd < 0.05
    assert found.ages_s["engine_speed_rpm"] == pytest.approx(3.0, abs=0.01)
    turning = found.engine_speed_rpm * pi / 30.0
    by_report, by_motion = (np.median(t * turning / found.fuel_power_w) for t in (found.reported_nm, found.observed_nm))
    assert by_report == pytest.approx(0.356, abs=0.005)
    assert by_motion == pytest.approx(0.322, abs=0.01)
    figure = torque_sources_figure(vars_of(found), theme=DARK)
    assert [trace["name"] for trace in figure["data"] if trace.get("showlegend", True)] == [
        "power steady", "power changing", "by the reported torque", "by the car's motion", "all moments",
    ]  # fmt: skip


def vars_of(found: TorqueSources) -> dict[str, FloatArray]:
    names = ("engine_speed_rpm", "gear", "reported_nm", "observed_nm", "observed_sd_nm", "fuel_power_w", "steady")
    return {name: getattr(found, name) for name in names}


def test_gears_are_drawn_apart() -> None:
    seen = drive(seconds=900.0)
    figure = torque_sources_figure(vars_of(compared(seen, reporting(seen, 1.05))))
    ratios = [trace for trace in figure["data"] if trace["name"].startswith("gear")]
    assert len(ratios) >= 3
    assert all(abs(y - 1.0 / 1.05) < 0.01 for trace in ratios for y in trace["y"])
