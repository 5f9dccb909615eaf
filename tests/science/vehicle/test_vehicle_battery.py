"""``<battery>`` in a car's XML: read, refused with its line, and written without touching anything else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.errors import VehicleConfigError
from app.science.fields import ProblemError
from app.science.vehicle.battery import BatterySpec
from app.science.vehicle.battery_document import battery_document, spec_of_document
from app.science.vehicle.battery_elements import GROUPS
from app.science.vehicle.battery_xml import with_battery
from app.science.vehicle.fields import apply_form, form_values
from app.science.vehicle.xml import config_fingerprint, examine_vehicle, new_car_xml, read_vehicle, write_vehicle

SAMPLE = Path(__file__).with_name("smart_roadster.xml").read_bytes()
TABLE_7: dict[str, Any] = {
    "ocv": [3.0, 1.2, -1.9, 1.3],
    "ocv_soc_range": [0.1, 0.9],
    "initial": {
        "capacity_ah": 2.2,
        "resistance_ohm": 0.01,
        "relaxation_capacitance_f": 3000.0,
        "relaxation_resistance_ohm": 0.01,
        "soc": 0.5,
    },
    "rated_capacity_ah": 2.0,
    "estimator": "gpc",
    "terms": 3,
    "sigma_range_1ps": [0.02, 0.05],
    "forgetting": 0.99999,
    "gains": {"alpha": 2e-14, "r": 1e-8, "beta": 1e-10, "xi": 1e-5, "x10": 100.0},
    "start_after_s": 86400.0,
    "series": 96,
    "parallel": 2,
    "voltage_noise_v": 0.002,
    "current_noise_a": 0.01,
    "current_bias_a": 0.02,
    "initial_sd": {
        "capacity_ah": 0.1,
        "resistance_ohm": 0.2,
        "relaxation_capacitance_f": 0.3,
        "relaxation_resistance_ohm": 0.3,
        "soc": 0.2,
    },
    "temperature": {"reference_c": 25.0, "resistance_k": 2500.0, "relaxation_k": 3000.0, "capacity_per_k": 0.004},
    "hysteresis": {"voltage_v": 0.012, "rate": 40.0},
}
"""MAUTC-2010-02, Tables 7 and 8, and everything else a configuration may say."""


def battery(inside: str) -> bytes:
    return f"<ponthy_config>\n<battery>\n{inside}\n</battery>\n</ponthy_config>".encode()


def test_a_configuration_survives_the_xml_and_the_xml_a_configuration() -> None:
    xml = with_battery(SAMPLE, TABLE_7, name="Traction", end_of_life=0.75)
    spec = read_vehicle(xml).battery
    assert spec is not None
    assert battery_document(spec) == TABLE_7
    assert (spec.name, spec.end_of_life) == ("Traction", 0.75)
    assert with_battery(xml, battery_document(spec)) == xml
    assert with_battery(xml, None) == SAMPLE
    assert examine_vehicle(xml).unknown == ()


def test_everything_that_can_be_said_is_in_a_document() -> None:
    said = {field.target.partition(".")[2] for fields in GROUPS.values() for field in fields}
    spec = spec_of_document(TABLE_7 | {"ocv": [[0.0, 3.0], [1.0, 3.5]]})
    left = {name for name in said if getattr(spec, name) in (None, (), "")}
    assert left == {"name", "ocv_coefficients"}
    assert said == set(BatterySpec.__dataclass_fields__)


def test_a_table_with_units_as_people_write_them() -> None:
    spec = read_vehicle(
        battery(
            '<capacity rated="2300 mAh"/><resistance ohm="8 mΩ"/><soc initial="70 %"/>\n'
            '<relaxation capacitance="2.7 kF" resistance="11mOhm"/><ocv soc="0; 0,5; 1" volts="3.0, 3.3, 3.4"/>'
        )
    ).battery
    assert spec == BatterySpec(
        rated_capacity_ah=2.3,
        resistance_ohm=0.008,
        soc=0.7,
        relaxation_capacitance_f=2700.0,
        relaxation_resistance_ohm=0.011,
        ocv_soc=(0.0, 0.5, 1.0),
        ocv_volts=(3.0, 3.3, 3.4),
    )
    assert spec.missing == ()
    assert battery_document(spec)["initial"]["capacity_ah"] == 2.3


@pytest.mark.parametrize(
    ("inside", "line", "element", "words"),
    [
        ('<capacity rated="-2"/>', 3, "capacity", "between 0.0001 and 100000 Ah"),
        ('\n<soc initial="70"/>', 4, "soc", "between -0.1 and 1.1; write 0.7 for 70 %"),
        ('<soc initial="50 Ah"/>', 3, "soc", "unit"),
        ('<cells series="2.5"/>', 3, "cells", "whole number"),
        ('<cells parallel="0"/>', 3, "cells", "between 1 and 5000"),
        ('<ocv soc="0 50 100" volts="3 3.3 3.5"/>', 3, "ocv", "between -0.5 and 1.5; write 0.7 for 70 %"),
        ('<ocv soc="0 0.5 1" volts="3 3.3"/>', 3, "ocv", "2 voltages for 3 states of charge"),
        ('<ocv soc="0 0.5 1"/>', 3, "ocv", "stands without battery/ocv@volts"),
        ('<ocv volts="3 4"/>', 3, "ocv", "stands without battery/ocv@soc"),
        ('<ocv soc="0.5" volts="3"/>', 3, "ocv", "two at least"),
        ('<ocv soc="0 0.6 0.5" volts="3 3.1 3.2"/>', 3, "ocv", "row 3: 0.5 isn't above the 0.6"),
        ('<ocv soc="0 0.5 1" volts="3 3.3 3.2"/>', 3, "ocv", "row 3: 3.2 V lie below the 3.3 V"),
        ('<ocv soc="0 1" volts="3 3"/>', 3, "ocv", "don't rise"),
        ('<ocv soc="0 x" volts="3 3"/>', 3, "ocv", "holds “x”"),
        ('<ocv coefficients="3.5 -0.5"/>', 3, "ocv", "doesn't rise"),
        ('<ocv coefficients="-1 0.5"/>', 3, "ocv", "constant one comes first"),
        ('<ocv coefficients="3 1" soc="0 1" volts="3 4"/>', 3, "ocv", "stands beside a table"),
        ('<ocv coefficients="3 1" from="0.9" to="0.1"/>', 3, "ocv", "0.1 isn't above"),
        ('<ocv coefficients="3 1" from="0.1"/>', 3, "ocv", "stands without battery/ocv@to"),
        ('<ocv from="0.1" to="0.9"/>', 3, "ocv", "stands without battery/ocv@coefficients"),
        ('<ocv soc="0 1" volts="3 4" from="0.1" to="0.9"/>', 3, "ocv", "belongs to a polynomial"),
        ('<estimator type="kalman"/>', 3, "estimator", "one of ekf_bias, ekf, ukf, gpc"),
        ('<gpc terms="3"/>\n<gpc sigmaMin="0.05" sigmaMax="0.02"/>', 4, "gpc", "isn't above"),
        ('<hysteresis voltage="0.01"/>', 3, "hysteresis", "stands without battery/hysteresis@rate"),
        ('<life end="80"/>', 3, "life", "between 0.05 and 1; write 0.7 for 70 %"),
    ],
)
def test_what_can_not_be_is_refused_with_line_and_element(inside: str, line: int, element: str, words: str) -> None:
    with pytest.raises(VehicleConfigError, match=words) as caught:
        read_vehicle(battery(inside))
    assert (caught.value.line, caught.value.element) == (line, f"ponthy_config/battery/{element}")


def test_an_unfinished_battery_is_taken_and_what_it_lacks_is_said() -> None:
    reading = examine_vehicle(battery('<capacity rated="33.1"/><resistance ohm="0.001"/>'))
    assert reading.vehicle.battery == BatterySpec(rated_capacity_ah=33.1, resistance_ohm=0.001)
    assert len(reading.warnings) == 1
    assert "its open-circuit curve and its relaxation capacitance and its relaxation resistance" in reading.warnings[0]
    assert reading.defaulted == examine_vehicle(b"<ponthy_config/>").defaulted


def test_a_polynomial_that_falls_in_places_is_remarked_on() -> None:
    warnings = examine_vehicle(battery('<ocv coefficients="3 1.5 -4 3.2"/>')).warnings
    assert any("falls at a state of charge of 0.285" in warning for warning in warnings)


def test_a_car_without_battery_has_none_in_the_form_and_the_form_may_add_one() -> None:
    for xml in (SAMPLE, new_car_xml()):
        assert read_vehicle(xml).battery is None
        assert {value for path, value in form_values(xml).items() if path.startswith("battery")} == {None}
    after = apply_form(SAMPLE, {"battery/ocv@soc": "0 1", "battery/ocv@volts": "3, 3,5", "battery/cells@series": 96.0})
    assert read_vehicle(after).battery == BatterySpec(series=96, ocv_soc=(0.0, 1.0), ocv_volts=(3.0, 3.5))
    assert apply_form(after, form_values(after)) == after
    assert read_vehicle(write_vehicle(after, read_vehicle(SAMPLE))).battery is None


SHAPES = [
    b"<ponthy_config/>",
    b"<?xml version='1.0'?><!-- a --><ponthy_config version='7' /><!-- b -->\n",
    b"<ponthy_config></ponthy_config>",
    b"<ponthy_config><battery/><!-- <battery> --></ponthy_config>",
    b"<ponthy_config>\r\n\t<mass  wet = '1000' />\r\n</ponthy_config>\r\n",
    b"<ponthy_config>\n  <x><battery name='not mine'/></x>\n  <![CDATA[<battery>]]>\n"
    b"  <file Name='a'/>\n</ponthy_config>",
    "<?xml version='1.0' encoding='utf-16'?>\n<ponthy_config><!-- Ž --><x/></ponthy_config>".encode("utf-16"),
    b"\xef\xbb\xbf<ponthy_config>\n  <battery name='old'><odd/></battery>\n</ponthy_config>\n",
    b"<?xml version='1.0' encoding='iso-8859-1'?><ponthy_config><battery name='\xe9'/>\n<!-- \xe9 --></ponthy_config>",
]


@pytest.mark.parametrize("xml", SHAPES, ids=range(len(SHAPES)))
def test_only_the_battery_changes_whatever_the_files_manner(xml: bytes) -> None:
    after = with_battery(xml, TABLE_7, name="Žofie & <co>")
    found = read_vehicle(after).battery
    assert found is not None
    assert (battery_document(found), found.name) == (TABLE_7, "Žofie & <co>")
    assert with_battery(after, battery_document(found)) == after
    changed = with_battery(after, TABLE_7 | {"series": 1})
    start = next(at for at, (old, new) in enumerate(zip(after, changed, strict=False)) if old != new)
    assert after[start:].startswith((b"9", b"\x009"))
    without = with_battery(after, None)
    assert read_vehicle(without).battery is None
    assert examine_vehicle(without).unknown == tuple(
        name for name in examine_vehicle(xml).unknown if not name.startswith("battery/")
    )
    if b"not mine" in xml or b"\t" in xml:  # there was none, and the place is a line of its own
        assert without == xml


def test_a_battery_makes_no_trip_outdated() -> None:
    with_one = with_battery(SAMPLE, TABLE_7)
    assert config_fingerprint(with_one) == config_fingerprint(SAMPLE)
    assert config_fingerprint(with_battery(with_one, None)) == config_fingerprint(SAMPLE)
    assert config_fingerprint(write_vehicle(with_one, {"mass@wet": 845.0})) != config_fingerprint(SAMPLE)


def test_two_batteries_become_one_and_a_file_that_is_no_car_is_refused() -> None:
    two = b"<ponthy_config>\n  <battery name='a'/>\n  <battery name='b'/>\n  <mass wet='900'/>\n</ponthy_config>"
    after = with_battery(two, TABLE_7)
    assert after.count(b"<battery") == 1
    assert after.endswith(b"</battery>\n  <mass wet='900'/>\n</ponthy_config>")
    with pytest.raises(VehicleConfigError, match="document type"):
        with_battery(b'<!DOCTYPE a [<!ENTITY b "c">]><ponthy_config/>', TABLE_7)
    with pytest.raises(VehicleConfigError, match="printable"):
        with_battery(SAMPLE, TABLE_7, name="a\nb")


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ([], "not an object"),
        ({"ovc": [3, 4]}, "ovc: is not a field of this configuration; did you mean ocv?"),
        ({"initial": {"capacity": 2}}, "initial.capacity: is not a field"),
        ({"ocv": "3 4"}, "neither coefficients nor rows"),
        ({"ocv": [[0, 3], [1]]}, r"ocv\[1\]: has 1 numbers"),
        ({"series": 1.5}, "series: 1.5 is not a whole number"),
        ({"terms": "three"}, "terms: 'three' is not a number"),
    ],
)
def test_a_document_that_no_xml_could_hold_is_refused_by_its_field(document: object, words: str) -> None:
    with pytest.raises(ProblemError, match=words):
        with_battery(SAMPLE, document)


curves = st.lists(st.floats(0.0, 1.0), min_size=2, max_size=9, unique=True).map(sorted)
names = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S")), max_size=20)


@given(st.floats(1e-4, 1e5), curves, st.floats(0.0, 900.0), st.floats(0.01, 400.0), names)
def test_numbers_come_back_exactly(capacity: float, soc: list[float], low: float, rise: float, name: str) -> None:
    rows = [[one, low + k * rise] for k, one in enumerate(soc)]
    document = {"ocv": rows, "initial": {"capacity_ah": capacity}, "series": 1, "parallel": 1}
    found = read_vehicle(with_battery(SAMPLE, document, name=name)).battery
    assert found is not None
    assert (battery_document(found), found.name) == (document, name)
