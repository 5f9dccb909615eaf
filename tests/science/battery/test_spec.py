"""A car's battery as the configuration of an estimate, and back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from app.science.battery.config import ESTIMATORS
from app.science.battery.config_reading import config_document
from app.science.battery.spec import config_of_spec, spec_of_config
from app.science.fields import ProblemError
from app.science.vehicle.battery_document import battery_document
from app.science.vehicle.battery_elements import ESTIMATORS as XML_ESTIMATORS
from app.science.vehicle.battery_elements import GROUPS
from app.science.vehicle.battery_xml import with_battery
from app.science.vehicle.field import Field
from app.science.vehicle.xml import read_vehicle

XML = b"""<ponthy_config>
  <battery>
    <cells series="96" parallel="2"/>
    <capacity rated="33.1"/>
    <resistance ohm="1.1 mOhm"/>
    <relaxation capacitance="20 kF" resistance="0.0009"/>
    <ocv soc="0 0.5 1" volts="3.0 3.7 4.1"/>
    <hysteresis voltage="0.01" rate="30"/>
    <uncertainty soc="0.3"/>
  </battery>
</ponthy_config>
"""


def test_what_the_xml_says_is_what_is_estimated_with() -> None:
    spec = read_vehicle(XML).battery
    assert spec is not None
    config = config_of_spec(spec)
    cell = config.cell
    assert (cell.series, cell.parallel, cell.circuit.capacity_ah, cell.circuit.resistance_ohm) == (96, 2, 33.1, 0.0011)
    assert cell.circuit.time_constant_s == pytest.approx(18.0)
    assert cell.curve.points == ((0.0, 3.0), (0.5, 3.7), (1.0, 4.1))
    assert cell.hysteresis is not None
    assert (config.estimator, config.rated_capacity_ah, config.initial_sd) == ("ekf_bias", 33.1, {"soc": 0.3})
    again = spec_of_config(config)
    assert config_of_spec(again) == config
    assert config_of_spec(read_vehicle(with_battery(XML, config_document(config))).battery or spec) == config


def test_renaming_a_battery_adds_nothing_to_it() -> None:
    spec = read_vehicle(XML).battery
    assert spec is not None
    after = with_battery(XML, battery_document(spec), name="Pack")
    assert read_vehicle(after).battery == replace(spec, name="Pack")


NUMBERS = [field for fields in GROUPS.values() for field in fields if field.kind == "number"]
BESIDE: dict[str, dict[str, Any]] = {
    "ocv_from": {"ocv_to": 1.5},
    "ocv_to": {"ocv_from": -0.5},
    "sigma_min_1ps": {"sigma_max_1ps": 100.0},
    "sigma_max_1ps": {"sigma_min_1ps": 1e-7},
}
"""What a value can't be without."""


@pytest.mark.parametrize("field", NUMBERS, ids=lambda field: field.path)
def test_what_the_xml_takes_can_be_estimated_with(field: Field) -> None:
    spec = read_vehicle(XML).battery
    assert spec is not None
    name = field.target.partition(".")[2]
    beside: dict[str, Any] = BESIDE.get(name, {})
    if name.startswith("ocv"):
        spec = replace(spec, ocv_soc=(), ocv_volts=(), ocv_coefficients=(3.0, 1.0))
    for limit in (field.minimum, field.maximum):
        assert limit is not None
        value = int(limit) if field.form == "whole" else limit
        if value not in beside.values():
            config_of_spec(replace(spec, **(beside | {name: value})))


def test_both_rooms_know_the_same_estimators() -> None:
    assert XML_ESTIMATORS == ESTIMATORS


def test_a_battery_that_lacks_its_curve_is_refused_by_name() -> None:
    spec = read_vehicle(b'<ponthy_config><battery><capacity rated="2"/></battery></ponthy_config>').battery
    assert spec is not None
    with pytest.raises(ProblemError, match="ocv: is missing"):
        config_of_spec(spec)
