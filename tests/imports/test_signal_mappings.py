"""Mapping files: names, scales, products, means, own times, conditions; and what a mapping can't be."""

from __future__ import annotations

import json

import numpy as np
import pytest

from app.imports.known import known_mappings
from app.imports.signals import SignalMapping, read_signals
from app.science.errors import SignalsError
from app.science.logger.recording import Recording


def read(data: bytes, mapping: dict[str, object]) -> Recording:
    return read_signals(data, filename="drive.csv", mapping=SignalMapping.from_json(json.dumps(mapping)))


def test_columns_are_renamed_and_scaled() -> None:
    recording = read(
        b"Time;Speed [km/h];yaw;note\n1000;36,0;90;a\n1500;72,0;0;b\n",
        {
            "time": {"column": "Time", "scale": 0.001, "offset": -1.0},
            "signals": {
                "Speed [km/h]": {"signal": "speed_mps", "scale": 1 / 3.6},
                "yaw": {"signal": "gz_radps", "scale": np.pi / 180},
            },
            "drop": ["note"],
        },
    )
    assert recording["speed_mps"].t_s.tolist() == [0.0, 0.5]
    np.testing.assert_allclose(recording["speed_mps"].value, [10.0, 20.0])
    np.testing.assert_allclose(recording["gz_radps"].value, [np.pi / 2, 0.0])
    assert recording.warnings == ()


def test_a_column_may_have_times_of_its_own() -> None:
    recording = read(
        b"t_s,rpm,rpm__t,v,v__t\n7,800,1.5,3,2.5\n14,900,8.5,4,9.5\n",
        {
            "signals": {
                "rpm": {"signal": "engine_speed_rpm", "time_column": "rpm__t"},
                "v": {"signal": "speed_mps", "time_column": "v__t"},
            }
        },
    )
    assert recording["engine_speed_rpm"].t_s.tolist() == [1.5, 8.5]
    assert recording["speed_mps"].t_s.tolist() == [2.5, 9.5]
    assert recording.warnings == ()


def test_a_percentage_is_multiplied_by_its_reference() -> None:
    torque = {"signal": "engine_torque_nm", "scale": 0.01, "times": "ref"}
    with_column = read(b"t_s,pct,ref\n0,50,200\n1,25,\n2,10,300\n", {"signals": {"pct": torque}})
    assert with_column["engine_torque_nm"].value.tolist() == [100.0, 50.0, 30.0]
    constant = read(b"t_s,pct\n0,50\n1,25\n", {"signals": {"pct": torque}, "constants": {"ref": 250}})
    assert constant["engine_torque_nm"].value.tolist() == [125.0, 62.5]
    events = b"t_s,signal,value\n0,pct,50\n0.4,ref,200\n1,pct,20\n2,ref,100\n3,pct,20\n"
    assert read(events, {"signals": {"pct": torque}})["engine_torque_nm"].value.tolist() == [100.0, 40.0, 20.0]
    without = read(b"t_s,pct,speed_mps\n0,50,1\n1,25,1\n", {"signals": {"pct": torque}})
    assert list(without) == ["speed_mps"]
    assert "pct needs “ref”" in without.warnings[0]


def test_wheels_are_averaged() -> None:
    wheels = {"signals": {"rl": {"signal": "speed_mps", "mean_with": ["rr"]}}, "drop": ["*"]}
    assert read(b"t_s,fl,rl,rr\n0,9,10,12\n1,9,11,12\n", wheels)["speed_mps"].value.tolist() == [11.0, 11.5]


def test_rows_may_have_to_meet_a_condition() -> None:
    condition = {"only_where": {"column": "fix", "minimum": 2}}
    recording = read(
        b"t_s,fix,lat,lon\n0,0,1,1\n1,3,49,6\n2,2,49.1,6.1\n3,1,49.2,6.2\n",
        {"signals": {"lat": {"signal": "lat_deg", **condition}, "lon": {"signal": "lon_deg", **condition}}},
    )
    assert recording["lat_deg"].t_s.tolist() == [1.0, 2.0]


def test_a_long_table_may_name_its_columns_otherwise() -> None:
    recording = read(
        b"when,what,how much\n0,RPM,800\n1,RPM,900\n1,Mood,3\n",
        {
            "time": {"column": "when"},
            "layout": {"signal": "what", "value": "how much"},
            "signals": {"RPM": {"signal": "engine_speed_rpm"}},
        },
    )
    assert recording["engine_speed_rpm"].value.tolist() == [800.0, 900.0]
    assert recording.warnings == ("Columns that aren't signals were left out: Mood.",)
    with pytest.raises(SignalsError, match="says that the table is long"):
        read(b"t_s,v\n0,1\n", {"layout": {"signal": "what", "value": "v"}})


def test_what_already_bears_a_signals_name_passes_unless_dropped() -> None:
    data = b"t_s,v,hdop,alt_m\n0,1,1.1,300\n1,2,1.2,301\n"
    recording = read(data, {"signals": {"v": {"signal": "speed_mps"}}, "drop": ["alt_m"]})
    assert list(recording) == ["speed_mps", "hdop"]


def test_the_first_of_two_sources_of_a_signal_is_taken() -> None:
    both = {"signals": {"a": {"signal": "speed_mps"}, "b": {"signal": "speed_mps"}}}
    recording = read(b"t_s,a,b\n0,1,2\n1,1,2\n", both)
    assert recording["speed_mps"].value.tolist() == [1.0, 1.0]
    assert recording.warnings == ("b is left out: speed_mps comes from an earlier column.",)


@pytest.mark.parametrize(
    ("mapping", "field", "words"),
    [
        ("[1]", "mapping", "object"),
        ("{", "mapping", "isn't JSON"),
        ('{"signals": {"v": {"signal": "velocity"}}}', "mapping.signals.v", "doesn't exist"),
        ('{"signals": {"v": {"signal": "speed_mps", "scale": "3"}}}', "mapping.signals.v.scale", "a number"),
        ('{"signals": {"v": {"signal": "speed_mps", "scale": NaN}}}', "mapping.signals.v.scale", "a number"),
        ('{"signals": {"v": {"signal": "speed_mps", "factor": 3}}}', "mapping.signals.v.factor", "isn't part"),
        ('{"signals": {"v": {"signal": "speed_mps", "only_where": {"minimum": 1}}}}', None, "must name a column"),
        (
            '{"signals": {"v": {"signal": "speed_mps", "mean_with": [1]}}}',
            "mapping.signals.v.mean_with",
            "list of texts",
        ),
        ('{"signals": {"v": 3}}', "mapping.signals.v", "object"),
        ('{"time": {"colunm": "t"}}', "mapping.time.colunm", "isn't part"),
        ('{"signal": {}}', "mapping.signal", "isn't part"),
        ('{"constants": {"a": true}}', "mapping.constants.a", "a number"),
    ],
)
def test_a_wrong_mapping_is_refused_where_it_is_wrong(mapping: str, field: str | None, words: str) -> None:
    with pytest.raises(SignalsError, match=words) as caught:
        SignalMapping.from_json(mapping)
    assert field in (None, caught.value.field)


def test_known_mappings_say_what_they_are_and_how_they_are_recognised() -> None:
    mappings = known_mappings()
    assert len({mapping.name for mapping in mappings}) == len(mappings) == 10
    for mapping in mappings:
        assert len(mapping.recognise) >= 3
        assert mapping.signals
