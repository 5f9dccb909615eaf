"""Whole estimates of a simulated cell, by an independent simulation, and what is said of records with faults."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.science.battery.config import ESTIMATORS, VALUES
from app.science.battery.config_reading import read_config
from app.science.battery.estimate import estimate
from app.science.battery.record import BatteryRecord
from app.science.errors import TooLittleData
from tests.science.battery.plain_cell import CONFIG, TRUTH, driven


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_every_estimator_answers_with_the_names_others_rely_on(estimator: str) -> None:
    document = estimate(driven(6000), read_config(CONFIG | {"estimator": estimator})).document()
    assert set(document) >= {*VALUES, *(f"{name}_sd" for name in VALUES), "soh", "soh_sd", "history", "warnings"}
    assert document["estimator"] == estimator
    assert len({len(column) for column in document["history"].values()}) == 1
    assert {"t_s", "residual_v", *VALUES} <= set(document["history"])
    json.dumps(document, allow_nan=False)


def test_the_default_finds_the_cell_from_a_wrong_beginning() -> None:
    record = driven(30_000)
    found = estimate(record, read_config(CONFIG))
    for name, value, sd in zip(VALUES[:4], found.values, found.sds, strict=False):
        assert abs(value - TRUTH[name]) < max(3.0 * sd, 0.003 * TRUTH[name]), name
    assert found.initial_soc == pytest.approx(TRUTH["soc"], abs=max(0.005, 3.0 * found.initial_soc_sd))
    assert found.voltage_rms_v == pytest.approx(0.002, rel=0.1)
    assert found.soh == pytest.approx(TRUTH["capacity_ah"] / CONFIG["initial"]["capacity_ah"], rel=0.005)
    assert found.warnings == ()


def test_health_is_a_share_of_the_rated_capacity_where_one_is_given() -> None:
    found = estimate(driven(3000), read_config(CONFIG | {"rated_capacity_ah": 4.0}))
    assert found.soh == pytest.approx(found.values[0] / 4.0)


def test_a_pack_says_the_same_of_a_cell_as_the_cell() -> None:
    record = driven(5000)
    pack = BatteryRecord(record.t_s, 3.0 * record.current_a, 96.0 * record.voltage_v)
    one = estimate(record, read_config(CONFIG))
    of_many = estimate(pack, read_config(CONFIG | {"series": 96, "parallel": 3}))
    np.testing.assert_allclose(of_many.values, one.values, rtol=1e-6)


def test_a_record_goes_on_where_the_one_before_ended() -> None:
    record, config = driven(20_000), read_config(CONFIG)
    half = 10_000
    columns = record.t_s, record.current_a, record.voltage_v
    before, after = (
        BatteryRecord(*(column[part] for column in columns)) for part in (slice(0, half + 1), slice(half, None))
    )
    first = estimate(before, config)
    second = estimate(after, config, first.carry)
    assert second.sds[0] < first.sds[0]
    assert second.values[0] == pytest.approx(estimate(record, config).values[0], rel=0.005)


def test_an_unknown_state_of_charge_is_looked_up_and_said() -> None:
    unknown = {name: value for name, value in CONFIG["initial"].items() if name != "soc"}
    found = estimate(driven(5000), read_config(CONFIG | {"initial": unknown}))
    assert found.initial_soc == pytest.approx(TRUTH["soc"], abs=0.03)
    assert any("read from the first voltage" in warning for warning in found.warnings)


def test_hardly_any_voltage_is_too_little() -> None:
    record = driven(100)
    volts = np.where(np.arange(100) < 5, record.voltage_v, np.nan)
    with pytest.raises(TooLittleData, match="5 rows with a voltage"):
        estimate(replace(record, voltage_v=volts), read_config(CONFIG))


def test_a_hole_with_an_unknown_current_opens_the_charge_up() -> None:
    record, config = driven(20_000), read_config(CONFIG)
    keep = np.ones(20_000, dtype=np.bool_)
    keep[8000:11_000] = False
    holed = BatteryRecord(record.t_s[keep], record.current_a[keep], record.voltage_v[keep])
    found = estimate(holed, config)
    whole = estimate(record, config)
    assert found.values[4] == pytest.approx(whole.values[4], abs=0.01)
    assert found.values[0] == pytest.approx(whole.values[0], rel=0.02)
    (said,) = found.warnings
    assert said.startswith("1 gap of 50 min from 7999 s on, during which an unknown current flowed")


def test_slow_rows_of_a_rest_or_of_a_constant_current_are_no_holes() -> None:
    record = driven(6000)
    parked = np.concatenate([record.t_s, record.t_s[-1] + np.array([1.0, 1801.0, 1802.0])])
    current = np.concatenate([record.current_a, np.zeros(3)])
    settled = np.full(3, record.voltage_v[-1] - TRUTH["resistance_ohm"] * record.current_a[-1])
    rested = BatteryRecord(parked, current, np.concatenate([record.voltage_v, settled]))
    assert not any("unknown current" in warning for warning in estimate(rested, read_config(CONFIG)).warnings)


def columns_of(document: dict[str, Any]) -> int:
    return len(document["history"]["t_s"])


def test_histories_are_short() -> None:
    assert columns_of(estimate(driven(9000), read_config(CONFIG)).document()) <= 2000
