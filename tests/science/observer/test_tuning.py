"""Presets and tuning files."""

from __future__ import annotations

import json

import pytest

from app.science.errors import TuningError
from app.science.observer.tuning import DEFAULT, THESIS_2010, tuning_from_dict, tuning_from_json, tuning_to_dict


def test_thesis_preset_is_tables_3_2_and_3_3() -> None:
    assert THESIS_2010.q_thrust == 90000
    assert THESIS_2010.q_pitch == 1.5625e-8
    assert THESIS_2010.q_fuel_power == 50000
    assert (THESIS_2010.acc_floor_i**2, THESIS_2010.acc_floor_j**2) == (1, 4)
    assert THESIS_2010.acc_floor_k**2 == pytest.approx(50)
    assert (THESIS_2010.r_distance, THESIS_2010.r_engine_angle, THESIS_2010.r_gps_vertical) == (0.05, 0.016, 1000)


@pytest.mark.parametrize("preset", [DEFAULT, THESIS_2010], ids=lambda preset: preset.name)
def test_a_preset_written_to_a_file_reads_back(preset) -> None:
    again = tuning_from_json(json.dumps(tuning_to_dict(preset)), preset.name)
    assert again == preset


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"q_thurst": 1}', "q_thurst: no such entry"),
        ('{"q_thrust": 0}', "q_thrust: 0 can't be a covariance"),
        ('{"r_distance": -1}', "r_distance: -1 can't"),
        ('{"r_distance": NaN}', "not a finite number"),
        ('{"r_distance": "1"}', "not a finite number"),
        ('{"base": "none"}', "there is no tuning called 'none'"),
        ('{"base": ["default"]}', "there is no tuning called"),
        ('{"q_thurst": 1}', "Did you mean q_thrust"),
        ('{"warp": 9}', "Entries are acc_floor_i"),
        ('{"q_thrust": 1' + 400 * "0" + "}", "not a finite number"),
        ('{"q_thrust": Infinity}', "not a finite number"),
        ('{"q_thrust": true}', "not a finite number"),
        ("\ufeff\x00", "not JSON"),
        (5000 * "[", "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        ("[1]", "JSON object"),
        ("{\n!", "line 2"),
    ],
)
def test_bad_tuning_is_answered_with_the_entry(text: str | bytes, said: str) -> None:
    with pytest.raises(TuningError, match=said.replace("(", r"\(")):
        tuning_from_json(text)


def test_what_a_file_leaves_out_comes_from_its_base() -> None:
    assert tuning_from_dict({"base": "thesis-2010", "q_thrust": 5}).r_distance == 0.05
