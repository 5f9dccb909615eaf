"""Configurations: what can't be is refused by its path, and what is read is written back the same."""

from __future__ import annotations

import json
from math import isnan
from typing import Any

import pytest

from app.science.battery.circuit import Hysteresis, Warmth
from app.science.battery.config import Gains
from app.science.battery.config_reading import config_document, read_config
from app.science.fields import ProblemError

TABLE = [[0.0, 3.0], [0.2, 3.2], [0.8, 3.3], [1.0, 3.6]]
INITIAL = {
    "capacity_ah": 2.2,
    "resistance_ohm": 0.01,
    "relaxation_capacitance_f": 3000.0,
    "relaxation_resistance_ohm": 0.01,
    "soc": 0.5,
}


def document(**changes: Any) -> dict[str, Any]:
    return {"ocv": TABLE, "initial": INITIAL, **changes}


def initial(**changes: Any) -> dict[str, Any]:
    return document(initial={**INITIAL, **changes})


def test_what_is_not_said_has_the_reports_values() -> None:
    config = read_config(document())
    assert config.estimator == "ekf_bias"
    assert config.gpc.gains == Gains(2e-14, 1e-8, 1e-10, 1e-5, 100.0)
    assert (config.gpc.terms, config.gpc.sigma_range_1ps, config.gpc.forgetting) == (3, (0.02, 0.05), 0.99999)
    assert (config.cell.series, config.cell.parallel, config.start_after_s) == (1, 1, 0.0)
    assert config.cell.circuit.capacity_as == pytest.approx(7920.0)


def test_everything_that_can_be_said_comes_back() -> None:
    full = document(
        ocv=[3.0, 0.5, -0.1],
        ocv_soc_range=[0.1, 0.9],
        estimator="gpc",
        terms=2,
        sigma_range_1ps=[0.01, 0.1],
        forgetting=0.9999,
        gains={"r": 2e-8, "x10": 50.0},
        start_after_s=86400.0,
        series=96,
        parallel=2,
        rated_capacity_ah=2.3,
        voltage_noise_v=0.002,
        current_noise_a=0.01,
        current_bias_a=0.05,
        initial_sd={"capacity_ah": 0.1, "soc": 0.3},
        temperature={"reference_c": 20.0, "resistance_k": 2000.0},
        hysteresis={"voltage_v": 0.01, "rate": 5.0},
    )
    config = read_config(full)
    assert config.gpc.gains == Gains(r=2e-8, x10=50.0)
    assert config.cell.warmth == Warmth(20.0, 2000.0)
    assert config.cell.hysteresis == Hysteresis(0.01, 5.0)
    assert config.cell.curve.soc_range == (0.1, 0.9)
    assert config.initial_sd == {"capacity_ah": 0.1, "soc": 0.3}
    assert read_config(json.loads(json.dumps(config_document(config)))) == config


def test_a_missing_state_of_charge_is_not_known_rather_than_refused() -> None:
    config = read_config(document(initial={name: value for name, value in INITIAL.items() if name != "soc"}))
    assert isnan(config.cell.soc)
    assert "soc" not in config_document(config)["initial"]


@pytest.mark.parametrize(
    ("given", "path", "words"),
    [
        ([], "configuration", "not an object"),
        (None, "configuration", "null"),
        ({}, "ocv", "is missing"),
        ({"ocv": TABLE}, "initial", "is missing"),
        (document(ocv="a"), "ocv", "no curve"),
        (document(ocv=[3.3]), "ocv", "two entries"),
        (document(ocv=[3.0, [1, 2]]), "ocv[1]", "mix"),
        (document(ocv=[[0.0, 3.0], [1.0]]), "ocv[1]", "1 numbers"),
        (document(ocv=[[0.0, 3.0], [1.0, "x"]]), "ocv[1][1]", "not a number"),
        (document(ocv=[[0.0, 3.0], [1.0, float("nan")]]), "ocv[1][1]", "finite"),
        (document(ocv=[[0.0, 3.0], [0.5, 3.4], [0.5, 3.5]]), "ocv[2]", "not above the row before"),
        (document(ocv=[[0.0, 3.0], [0.5, 3.4], [1.0, 3.3]]), "ocv[2]", "must not fall"),
        (document(ocv=[[0.0, 3.0], [50.0, 3.4], [100.0, 3.5]]), "ocv", "percent"),
        (document(ocv=[[1.0, 3.6], [0.5, 3.3], [0.0, 3.0]]), "ocv", "turn the list round"),
        (document(ocv=[[0.0, 3.3], [1.0, 3.3]]), "ocv", "does not rise"),
        (document(ocv=[3.4, -0.2]), "ocv", "does not rise"),
        (document(ocv=[0.5, -40.0, 3.0]), "ocv", "coefficients ascend"),
        (document(ocv=[3.0, None]), "ocv[1]", "not a number"),
        (document(ocv_soc_range=[0.1, 0.9]), "ocv_soc_range", "belongs to polynomials"),
        (document(ocv=[3.0, 0.5], ocv_soc_range=[0.9, 0.1]), "ocv_soc_range", "not below"),
        (initial(soc=70.0), "initial.soc", "percent"),
        (initial(soc=-0.3), "initial.soc", "allowed is from"),
        (initial(capacity_ah=0.0), "initial.capacity_ah", "out of range"),
        (initial(capacity_ah="2"), "initial.capacity_ah", "not a number"),
        (initial(capacity_ah=True), "initial.capacity_ah", "not a number"),
        (initial(capacity=2.0), "initial.capacity", "did you mean capacity_ah"),
        (document(initial={"capacity_ah": 2.0}), "initial.resistance_ohm", "is missing"),
        (document(initial=None), "initial", "not an object"),
        (document(estimator="ekf-bias"), "estimator", "did you mean ekf_bias"),
        (document(estimator=["ekf"]), "estimator", "none of"),
        (document(terms=2.5), "terms", "not a whole number"),
        (document(terms=0), "terms", "out of range"),
        (document(sigma_range_1ps=[0.05, 0.02]), "sigma_range_1ps", "not below"),
        (document(sigma_range_1ps=[0.05]), "sigma_range_1ps", "2 are needed"),
        (document(forgetting=1.01), "forgetting", "out of range"),
        (document(gains={"gamma": 1.0}), "gains.gamma", "not a field"),
        (document(gains={"r": -1.0}), "gains.r", "out of range"),
        (document(series=0), "series", "out of range"),
        (document(start_after_s=-1), "start_after_s", "out of range"),
        (document(temperature={"reference_k": 298}), "temperature.reference_k", "not a field"),
        (document(hysteresis={"voltage_v": 0.01}), "hysteresis.rate", "is missing"),
        (document(initial_sd={"soc": 20}), "initial_sd.soc", "out of range"),
        (document(estimater="ekf"), "estimater", "did you mean estimator"),
    ],
)
def test_what_cannot_be_is_named_with_what_is_allowed(given: object, path: str, words: str) -> None:
    with pytest.raises(ProblemError) as refused:
        read_config(given)
    assert refused.value.path == path or str(refused.value).startswith(f"{path}:")
    assert words in str(refused.value)


def test_a_small_dip_of_a_measured_table_is_let_through() -> None:
    config = read_config(document(ocv=[[0.0, 3.0], [0.5, 3.302], [0.6, 3.300], [1.0, 3.5]]))
    assert config.cell.curve.falls() is not None


@pytest.mark.parametrize(("capacity_ah", "bias_a"), [(1.0, 0.02), (50.0, 0.5)])
def test_a_large_cells_sensor_may_be_off_by_more(capacity_ah: float, bias_a: float) -> None:
    assert read_config(initial(capacity_ah=capacity_ah)).current_bias_a == bias_a
    assert read_config(initial(capacity_ah=capacity_ah) | {"current_bias_a": 0.003}).current_bias_a == 0.003
