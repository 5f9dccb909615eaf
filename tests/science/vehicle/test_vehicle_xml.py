"""The thesis' sample car, values that are missing, odd or impossible, and files that are not a car."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from app.science.errors import VehicleConfigError
from app.science.vehicle.model import Injection, Vehicle
from app.science.vehicle.xml import config_fingerprint, examine_vehicle, new_car_xml, read_vehicle, write_vehicle

SAMPLE = Path(__file__).with_name("smart_roadster.xml").read_bytes()


def car(inside: str) -> bytes:
    return f"<ponthy_config>\n{inside}\n</ponthy_config>".encode()


def test_every_element_of_the_thesis_sample_is_read() -> None:
    vehicle = read_vehicle(SAMPLE)
    expected = {
        "owner": "Kenn Sebesta",
        "make": "Smart",
        "model": "Roadster",
        "year": "2004",
        "color": "grey",
        "engine_type": "698cc Inline 3 Turbo Suprex",
        "cylinders": 3,
        "displacement_l": 0.698,
        "max_power_w": 60_000.0,
        "max_power_rpm": 5250.0,
        "max_torque_nm": 110.0,
        "max_torque_rpm": 4500.0,
        "compression_ratio": 9.0,
        "idle_rpm": 850.0,
        "engine_inertia_kgm2": 0.061,
        "tyre": "205/45 R16",
        "wheel_radius_m": 0.2954,
        "wheel_inertia_kgm2": 0.62,
        "accelerometer_type": "LIS3LV02DL",
        "transmission_type": "6-spd sequential",
        "reverse_ratio": None,
        "gear_ratios": (13.25, 9.604, 7.37, 5.796, 4.208, 3.23),
        "cd": 0.39,
        "crr": 0.0125,
        "frontal_area_m2": 1.93,
        "mass_wet_kg": 844.0,
        "load_kg": 75.0,
        "injection": Injection(0.008, -0.0004, "sequential", 1),
        "vss_m_per_tick": 0.270183975491887,
        "fuel_name": "petrol",
        "fuel_energy_j_per_l": 32.0e6,
        "battery": None,
        "files": ("2009-10-27.dat", "2009-10-28.dat", "2009-10-30.dat", "2009-11-01.dat"),
    }
    assert {name: getattr(vehicle, name) for name in expected} == expected
    mounting = vehicle.mounting
    assert (mounting.roll_rad, mounting.pitch_rad, mounting.yaw_rad, mounting.scale) == (
        2.58287237237842,
        0.0277744014756975,
        1.66349305108413,
        0.989656407165839,
    )
    others = {"mounting", "speed_scale", "fuel_density_kg_per_l", "air_density_kgpm3", "gravity_mps2"}
    assert {field.name for field in fields(Vehicle)} == expected.keys() | others


def test_the_sample_needs_no_default_but_fuel_and_injection_and_raises_no_eyebrow() -> None:
    reading = examine_vehicle(SAMPLE)
    assert reading.defaulted == ("inj/system@type", "fuel@type")
    assert reading.warnings == ()
    assert reading.unknown == ()


def test_the_accelerated_mass_counts_wheels_and_drivetrain() -> None:
    vehicle = read_vehicle(SAMPLE)
    assert vehicle.accelerated_mass_kg(0) == pytest.approx(948.0, abs=1.0)  # Table 3.1
    drivetrain = [vehicle.accelerated_mass_kg(gear) - vehicle.accelerated_mass_kg(0) for gear in range(1, 7)]
    assert drivetrain == pytest.approx([123, 64, 38, 23, 12, 7], abs=0.6)


def test_the_mounting_turns_the_resting_sensor_upright() -> None:
    mounting = read_vehicle(SAMPLE).mounting
    turned = mounting.matrix / mounting.scale
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(turned) == pytest.approx(1.0)
    up = np.array([0.0, 0.0, -1.0])
    np.testing.assert_allclose(turned @ (turned.T @ up), up, atol=1e-14)


def test_an_empty_car_is_all_defaults_and_says_so() -> None:
    reading = examine_vehicle(car(""))
    assert reading.vehicle == Vehicle()
    assert {"mass@wet", "drag/aero@Cd", "wheels/tire@summer", "inj/timing@pattern"} <= set(reading.defaulted)
    assert not {"car/owner@owner", "engine/displacement@displacement"} & set(reading.defaulted)


def test_the_load_is_a_setting() -> None:
    assert read_vehicle(SAMPLE).mass_kg == 919.0
    assert read_vehicle(SAMPLE, load_kg=0.0).mass_kg == 844.0
    with pytest.raises(VehicleConfigError, match="load"):
        read_vehicle(SAMPLE, load_kg=float("nan"))


def test_a_measured_radius_stands_above_the_tyre() -> None:
    vehicle = read_vehicle(car('<wheels><tire summer="205/45 R16"/><radius m="28,8 cm"/></wheels>'))
    assert vehicle.wheel_radius_m == pytest.approx(0.288)
    assert vehicle.tyre == "205/45 R16"


@pytest.mark.parametrize(
    ("element", "energy_mj_per_l", "density"),
    [
        ("", 32.0, 0.745),
        ('<fuel type="diesel"/>', 36.0, 0.835),
        ('<fuel type="E10"/>', 30.9, 0.750),
        ('<fuel type="autogas"/>', 24.0, 0.522),
        ('<fuel type="petrol" energy="31,66"/>', 31.66, 0.745),
        ('<fuel type="methanol" energy="15.8" density="0.792"/>', 15.8, 0.792),
    ],
)
def test_the_fuel_sets_energy_and_density(element: str, energy_mj_per_l: float, density: float) -> None:
    vehicle = read_vehicle(car(element))
    assert vehicle.fuel_energy_j_per_l == pytest.approx(energy_mj_per_l * 1e6)
    assert vehicle.fuel_density_kg_per_l == density


def test_injectors_may_fire_in_groups() -> None:
    grouped = '<engine><type type="V6"/></engine><inj><timing pattern="grouped" groups="3"/></inj>'
    vehicle = read_vehicle(car(grouped))
    assert vehicle.injection.groups == 3
    assert vehicle.engine_angle_per_pulse_rad == pytest.approx(4 * np.pi / 3)
    simultaneous = read_vehicle(car(grouped.replace("grouped", "Simultaneous")))
    assert simultaneous.engine_angle_per_pulse_rad == pytest.approx(4 * np.pi / 6)


@pytest.mark.parametrize(
    ("inside", "line", "element", "words"),
    [
        ('<mass wet="-844"/>', 2, "mass", "between 50 and 60000 kg"),
        ('\n\n<mass wet="heavy"/>', 4, "mass", "isn't a number"),
        ('<drag>\n<rolling Crr="0.125"/></drag>', 3, "drag/rolling", "between 0 and 0.1"),
        ('<drag><aero Cd="3.9"/></drag>', 2, "drag/aero", "between 0 and 2"),
        (
            '<accelerometer><calibration><scale scale="9.81"/></calibration></accelerometer>',
            2,
            "accelerometer/calibration/scale",
            "between 0.5 and 2",
        ),
        (
            '<accelerometer><calibration><roll phi="148"/></calibration></accelerometer>',
            2,
            "accelerometer/calibration/roll",
            "write 90° if degrees",
        ),
        ('<transmission><first gear="-13"/></transmission>', 2, "transmission/first", "between 0.1 and 100"),
        (
            '<transmission><first gear="9.6"/>\n<second gear="13.2"/></transmission>',
            3,
            "transmission/second",
            "ratios must fall",
        ),
        (
            '<transmission><first gear=""/><second gear="9"/></transmission>',
            2,
            "transmission/second",
            "without a first",
        ),
        ('<engine><displacement displacement="698"/></engine>', 2, "engine/displacement", "between 0.02 and 30 l"),
        ('<engine><power power="60kW @fast"/></engine>', 2, "engine/power", "isn't a number"),
        ('<engine><power power="60kW @5"/></engine>', 2, "engine/power", "engine speed"),
        ('<wheels><tire summer="16 inch"/></wheels>', 2, "wheels/tire", "205/45 R16"),
        ('<inj><timing pattern="random"/></inj>', 2, "inj/timing", "sequential, grouped, simultaneous"),
        ('<inj><timing pattern="grouped"/></inj>', 2, "inj/timing", "number of injector groups"),
        ('<inj><timing pattern="grouped" groups="2.5"/></inj>', 2, "inj/timing", "whole number"),
        ('<fuel type="kerosene"/>', 2, "fuel", "give its energy"),
        ('<mass wet="1e400"/>', 2, "mass", "between 50"),
        (f'<car><make make="{"x" * 600}"/></car>', 2, "car/make", "at most 500"),
    ],
)
def test_what_can_not_be_is_refused_with_line_and_element(inside: str, line: int, element: str, words: str) -> None:
    with pytest.raises(VehicleConfigError, match=words) as caught:
        read_vehicle(car(inside))
    assert (caught.value.line, caught.value.element) == (line, f"ponthy_config/{element}")
    assert f"Line {line}" in str(caught.value)


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ('<drag><aero Cd="0.05"/></drag>', "unusual: most cars have 0.1 to 1.2"),
        ('<transmission><first gear="3.5"/></transmission>', "final drive"),
        ('<mass wet="844"/>\n<mass wet="900"/>', "more than once"),
        ('<inj><timing pattern="simultaneous"/></inj>', "doesn't tell its cylinders"),
    ],
)
def test_what_is_odd_is_taken_with_a_warning(inside: str, words: str) -> None:
    warnings = examine_vehicle(car(inside)).warnings
    assert len(warnings) == 1
    assert words in warnings[0]


def test_unknown_elements_are_named() -> None:
    assert examine_vehicle(car('<mass dry="800"/><x><y z="1"/></x>')).unknown == ("mass@dry", "x/y@z")


BOMB = b"""<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;"><!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;">
<!ENTITY e "&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;"><!ENTITY f "&e;&e;&e;&e;&e;&e;&e;&e;&e;&e;">]>
<ponthy_config><car><make make="&f;&f;&f;&f;&f;&f;&f;&f;"/></car></ponthy_config>"""


@pytest.mark.parametrize(
    ("xml", "line", "words"),
    [
        (b"", 0, "empty"),
        (b"\x00" * 512, 0, "empty"),
        (b"t_s,speed_mps\n0,1\n", 1, "isn't well-formed XML"),
        (SAMPLE[:700], 26, "isn't well-formed XML"),
        (b"<car><make/></car>", 1, "begins with <ponthy_config>"),
        (b'<a:ponthy_config xmlns:a="urn:x"/>', 1, "begins with <ponthy_config>"),
        (b"<!DOCTYPE ponthy_config>\n<ponthy_config/>", 1, "document type"),
        (b'\n<!DOCTYPE p SYSTEM "file:///etc/passwd">\n<ponthy_config/>', 2, "document type"),
        (BOMB, 2, "document type"),
        (
            BOMB.decode().replace('version="1.0"', 'version="1.0" encoding="UTF-16"').encode("utf-16"),
            2,
            "document type",
        ),
        (b'<ponthy_config>\n<mass wet="&heavy;"/></ponthy_config>', 2, "isn't well-formed XML"),
        (b"<ponthy_config>" + b"\n<x>" * 200 + b"</x>" * 200 + b"</ponthy_config>", 34, "nested"),
        (b"<ponthy_config>" + b"<x/>" * 20_001 + b"</ponthy_config>", 0, "more than 20000 elements"),
        (b"<ponthy_config>" + b" " * 1_000_001 + b"</ponthy_config>", 0, "at most 1000000"),
        (b"\xff\xfe\x00\x00 not xml", 1, "isn't well-formed XML"),
    ],
)
def test_what_is_not_a_car_is_refused_with_its_line(xml: bytes, line: int, words: str) -> None:
    with pytest.raises(VehicleConfigError, match=words) as caught:
        read_vehicle(xml)
    assert caught.value.line == line


def test_the_fingerprint_sees_meaning_and_not_manner() -> None:
    same = SAMPLE.replace(b" />", b"/>").replace(b"\n  ", b"\n\t").replace(b"<drag>", b"<drag><!-- air -->")
    assert config_fingerprint(same) == config_fingerprint(SAMPLE)
    utf16 = SAMPLE.decode().replace('encoding="UTF-8"', 'encoding="UTF-16"').encode("utf-16")
    assert config_fingerprint(utf16) == config_fingerprint(SAMPLE)
    assert config_fingerprint(write_vehicle(SAMPLE, {"mass@wet": 845.0})) != config_fingerprint(SAMPLE)
    assert len(config_fingerprint(SAMPLE)) == 64


@pytest.mark.parametrize("system", ["direct", "dual"])
def test_an_engine_whose_pulses_do_not_tell_its_fuel_is_remarked_on(system: str) -> None:
    xml = new_car_xml({"inj/system@type": system})
    reading = examine_vehicle(xml)
    assert reading.vehicle.injection.system == system
    assert any("fuel rate (fuel_rate_lph)" in remark for remark in reading.warnings)
    assert not examine_vehicle(new_car_xml({"inj/system@type": "port"})).warnings
