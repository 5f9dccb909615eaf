"""Signals tables in Ponthy's own names: every form, every disorder, every refusal."""

from __future__ import annotations

import gzip
import io

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.exports.parquet import recording_parquet
from app.imports import table
from app.imports.signals import SignalMapping, read_signals
from app.science.errors import SignalsError
from app.science.logger.recording import SIGNAL_UNITS, Recording, Series

WIDE = b"t_s,speed_mps,engine_speed_rpm\n0,10,2000\n0.5,10.5,2010\n1.0,11,2020\n"


def read(data: bytes, mapping: SignalMapping | None = None) -> Recording:
    return read_signals(data, filename="drive.csv", mapping=mapping)


def parquet(**columns: object) -> bytes:
    sink = io.BytesIO()
    pq.write_table(pa.table(columns), sink)
    return sink.getvalue()


def speed(recording: Recording) -> tuple[list[float], list[float]]:
    stream = recording["speed_mps"]
    return stream.t_s.tolist(), stream.value.tolist()


@pytest.mark.parametrize(
    "data",
    [
        WIDE,
        gzip.compress(WIDE),
        gzip.compress(WIDE[:40]) + gzip.compress(WIDE[40:]),
        b"\xef\xbb\xbf" + WIDE,
        WIDE.replace(b"\n", b"\r\n"),
        WIDE.decode().encode("utf-16"),
        WIDE.replace(b",", b"\t"),
        WIDE.replace(b",", b";").replace(b".", b","),
        WIDE.replace(b"t_s,speed_mps", b' "T_s" , Speed_mps '),
        b"# exported by hand\nsep=,\n\n" + WIDE,
        WIDE + b"\n\n  \n",
        b"t_s,signal,value\n0,speed_mps,10\n0,engine_speed_rpm,2000\n0.5,engine_speed_rpm,2010\n0.5,speed_mps,10.5\n"
        b"1,speed_mps,11\n1,engine_speed_rpm,2020\n",
        parquet(t_s=[0.0, 0.5, 1.0], speed_mps=[10.0, 10.5, 11.0], engine_speed_rpm=[2000, 2010, 2020]),
        parquet(
            t_s=[0.0, 0.5, 1.0] * 2,
            signal=["speed_mps"] * 3 + ["engine_speed_rpm"] * 3,
            value=[10.0, 10.5, 11.0, 2000.0, 2010.0, 2020.0],
        ),
    ],
    ids=[
        "comma", "gzip", "gzip-twice", "bom", "crlf", "utf-16", "tab", "decimal-comma", "header", "preamble",
        "blank-lines", "long", "parquet", "long-parquet",
    ],
)  # fmt: skip
def test_every_form_of_the_table_gives_the_same_recording(data: bytes) -> None:
    recording = read(data)
    assert list(recording) == ["speed_mps", "engine_speed_rpm"]
    assert speed(recording) == ([0.0, 0.5, 1.0], [10.0, 10.5, 11.0])
    assert recording["engine_speed_rpm"].value.tolist() == [2000.0, 2010.0, 2020.0]
    assert recording.warnings == ()
    assert recording.started_at_utc_s is None


def test_empty_cells_are_samples_that_were_not_taken() -> None:
    recording = read(b"t_s,speed_mps,hdop\n0,10,\n1,NaN,1.2\n2,,\n3,13,null\n")
    assert speed(recording) == ([0.0, 3.0], [10.0, 13.0])
    assert recording["hdop"].t_s.tolist() == [1.0]
    assert recording.warnings == ()


def test_bad_rows_are_left_out_and_said() -> None:
    recording = read(b"t_s,speed_mps\n0,10\n1,fast\n2,12,99\nx,13\n4,14\n5,900\n")
    assert speed(recording) == ([0.0, 4.0], [10.0, 14.0])
    text = "\n".join(recording.warnings)
    assert "1 row has another number of columns than the header and were left out (first: row 4)" in text
    assert "t_s: 1 cell that isn't a number counts as empty (first in row 5: “x”)" in text
    assert "speed_mps: 1 cell that isn't a number counts as empty (first in row 3: “fast”)" in text
    assert "1 row has no time in “t_s” and were left out (first: row 5)" in text
    assert "speed_mps: 1 value outside -30 to 150 m/s left out (first: 900 in row 7)" in text


def test_disorder_and_repeats_are_mended_and_said() -> None:
    recording = read(b"t_s,speed_mps\n0,10\n2,12\n1,11\n2,99\n3,13\n")
    assert speed(recording) == ([0.0, 1.0, 2.0, 3.0], [10.0, 11.0, 12.0, 13.0])
    assert recording.warnings == (
        "speed_mps: time went backwards once and was sorted (first: row 4).",
        "speed_mps: 1 value at the same time as an earlier one left out (first: row 5).",
    )


def test_signals_with_the_same_trouble_share_a_sentence() -> None:
    recording = read(b"t_s,ax_mps2,ay_mps2,az_mps2\n1,0,0,9.8\n0,0,0,9.8\n2,1,1,9.7\n")
    assert recording.warnings == ("ax_mps2, ay_mps2, az_mps2: time went backwards once and was sorted (first: row 3).",)


def test_axes_and_fixes_share_their_times() -> None:
    recording = read(
        b"t_s,ax_mps2,ay_mps2,az_mps2,lat_deg,lon_deg,hdop\n0,1,2,9,49,6,1.5\n1,1,,9,49.1,6.1,\n2,1,2,9,0,0,9\n"
        b"3,1,2,9,49.3,,\n4,1,2,9,49.4,6.4,\n"
    )
    for name in ("ax_mps2", "ay_mps2", "az_mps2"):
        assert recording[name].t_s.tolist() == [0.0, 2.0, 3.0, 4.0]
    for name in ("lat_deg", "lon_deg", "hdop"):
        assert recording[name].t_s.tolist() == [0.0, 1.0, 4.0]
    assert recording["hdop"].value.tolist() == [1.5, 1.5, 9.0]
    text = "\n".join(recording.warnings)
    assert "ax_mps2, ay_mps2, az_mps2: 1 value without partners at the same time left out" in text
    assert "0° north, 0° east" in text


def test_axes_sampled_one_after_the_other_are_brought_together() -> None:
    t = np.arange(300) * 0.01
    rows = "\n".join(f"{t[i]:.2f},{('ax_mps2', 'ay_mps2', 'az_mps2')[i % 3]},{t[i] + i % 3:.4f}" for i in range(300))
    recording = read(f"t_s,signal,value\n{rows}\n".encode())
    np.testing.assert_array_equal(recording["ax_mps2"].t_s, recording["az_mps2"].t_s)
    np.testing.assert_allclose(recording["ay_mps2"].value[1:], recording["ay_mps2"].t_s[1:] + 1.0, atol=1e-9)
    assert "interpolated" in recording.warnings[0]


def test_latitude_without_longitude_is_no_place() -> None:
    recording = read(b"t_s,lat_deg,speed_mps\n0,49,1\n1,49,1\n")
    assert list(recording) == ["speed_mps"]
    assert "without its partner" in recording.warnings[0]


@pytest.mark.parametrize("scale", [1.0, 1e3, 1e6, 1e9], ids=["s", "ms", "us", "ns"])
def test_seconds_since_1970_set_the_start(scale: float) -> None:
    start = 1_700_000_000
    rows = "\n".join(f"{int((start + i * 0.5) * scale) if scale > 1 else start + i * 0.5},{i}" for i in range(4))
    recording = read(f"timestamp,speed_mps\n{rows}\n".encode())
    assert recording.started_at_utc_s == pytest.approx(start, abs=1e-6)
    np.testing.assert_allclose(recording["speed_mps"].t_s, [0.0, 0.5, 1.0, 1.5], atol=1e-6)
    assert recording.warnings == ()


@pytest.mark.parametrize(
    "data",
    [
        b"time,speed_mps\n2024-09-07T07:44:30Z,1\n2024-09-07T07:44:30.500Z,2\n",
        b"time,speed_mps\n2024-09-07T09:44:30+02:00,1\n2024-09-07T09:44:30.500+02:00,2\n",
        b"time,speed_mps\n2024-09-07 07:44:30,1\n2024-09-07 07:44:30.500,2\n",
        parquet(time=pa.array([1725695070_000, 1725695070_500], pa.timestamp("ms")), speed_mps=[1.0, 2.0]),
        parquet(time=pa.array([1725695070_000, 1725695070_500], pa.timestamp("ms", "UTC")), speed_mps=[1.0, 2.0]),
    ],
    ids=["zulu", "zone", "plain", "parquet", "parquet-utc"],
)
def test_dates_set_the_start(data: bytes) -> None:
    recording = read(data)
    assert recording.started_at_utc_s == 1725695070.0
    assert recording["speed_mps"].t_s.tolist() == [0.0, 0.5]


def test_a_receivers_utc_sets_the_start_even_if_some_stamps_come_late() -> None:
    rows = "\n".join(f"{i},{1_700_000_000 + i - (0.9 if i % 5 == 0 else 0.0)}" for i in range(21))
    recording = read(f"t_s,utc_s\n{rows}\n".encode())
    assert recording.started_at_utc_s == pytest.approx(1_700_000_000.0)
    assert recording["utc_s"].t_s[0] == 0.0


def test_stamps_from_before_the_clock_was_set_are_left_out() -> None:
    recording = read(b"t_s,speed_mps\n3,1\n1700000000,2\n1700000001,3\n1700000002,4\n")
    assert speed(recording) == ([0.0, 1.0, 2.0], [2.0, 3.0, 4.0])
    assert recording.started_at_utc_s == 1_700_000_000.0
    assert "before the logger's clock was set" in recording.warnings[0]


def test_a_loggers_own_time_is_kept_unless_it_is_far_off() -> None:
    assert speed(read(b"t_s,speed_mps\n16.8,1\n17,2\n"))[0] == [16.8, 17.0]
    late = read(b"t_s,speed_mps\n86400,1\n86401,2\n")
    assert speed(late)[0] == [0.0, 1.0]
    assert late.warnings == ("Times began at 86400 s; they are counted from the first one.",)
    assert late.texts == {"clock_zero_s": "86400.0"}


def test_columns_that_are_no_signals_are_named() -> None:
    recording = read(WIDE.replace(b"engine_speed_rpm", b"mood"))
    assert recording.warnings == ("Columns that aren't signals were left out: mood.",)


def test_a_torn_gzip_gives_what_is_good() -> None:
    rows = "".join(f"{i},{i % 50}.{i * 7919 % 1000:03d}\n" for i in range(5000))
    packed = gzip.compress(b"t_s,speed_mps\n" + rows.encode())
    recording = read(packed[: len(packed) // 2])
    assert 1000 < len(recording["speed_mps"]) < 5000
    assert "breaks off" in recording.warnings[0]


def test_a_bomb_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    bomb = gzip.compress(b"t_s,speed_mps\n" + b"0" * 9_000_000)
    assert len(bomb) < 10_000
    monkeypatch.setattr(table, "LARGEST_BYTES", 5_000_000)
    with pytest.raises(SignalsError, match="more than 5 MB"):
        read(bomb)
    packed = parquet(t_s=np.arange(1000.0), speed_mps=np.zeros(1000), hdop=np.zeros(1000))
    monkeypatch.setattr(table, "MOST_CELLS", 2000)
    with pytest.raises(SignalsError, match="1000 rows of 3 columns"):
        read(packed)


@pytest.mark.parametrize(
    ("data", "row", "field", "words"),
    [
        (b"", 0, "", "empty"),
        (b"# nothing\n\n", 0, "", "empty"),
        (b"t_s\n1\n", 1, "", "no columns"),
        (b"t_s,speed_mps\n", 1, "", "no row"),
        (b"a,b\n1,2\n", 1, "t_s", "no column of times"),
        (b"t_s,mood\n1,2\n", 0, "", "no signal that can be used"),
        (b"t_s,speed_mps\n0,fast\n1,slow\n", 2, "speed_mps", "isn't a number"),
        (b"t_s,speed_mps\nnoon,1\nevening,2\n", 2, "t_s", "can't be read"),
        (b"t_s,speed_mps\n,\n,\n", 2, "", "no row that can be read"),
        (b"PAR1 no more", 0, "", "Parquet"),
        (b"\x1f\x8b\x08\x00 torn", 0, "", "damaged from its beginning"),
        (b"t_s,speed_mps\n0,9999\n1,9999\n", 0, "", "no signal that can be used"),
    ],
)
def test_what_can_not_be_used_is_refused_with_row_and_column(data: bytes, row: int, field: str, words: str) -> None:
    with pytest.raises(SignalsError, match=words) as caught:
        read(data)
    assert (caught.value.row, caught.value.field) == (row, field)


def test_a_damaged_parquet_file_is_refused() -> None:
    good = parquet(t_s=np.arange(1000.0), speed_mps=np.arange(1000.0) % 30)
    assert len(read(good)["speed_mps"]) == 1000
    with pytest.raises(SignalsError, match="damaged or breaks off"):
        read(good[: len(good) // 2])


def equal(one: Recording, other: Recording) -> bool:
    return (
        list(one) == list(other)
        and one.started_at_utc_s == other.started_at_utc_s
        and dict(one.texts) == dict(other.texts)
        and one.warnings == other.warnings
        and all(
            np.array_equal(one[name].t_s, other[name].t_s) and np.array_equal(one[name].value, other[name].value)
            for name in one
        )
    )


times = st.lists(st.floats(0, 1e5, allow_subnormal=False), min_size=1, max_size=20, unique=True).map(sorted)
recordings = st.builds(
    Recording,
    st.dictionaries(
        st.sampled_from(sorted(SIGNAL_UNITS)),
        times.map(lambda t: Series(np.array(t), np.sin(np.array(t)) * 1e5)),
        min_size=1,
    ),
    st.none() | st.floats(0, 4e9),
    st.dictionaries(st.sampled_from(["nmea", "source"]), st.text(max_size=30)),
    st.lists(st.text(max_size=20), max_size=3).map(tuple),
)


@given(recordings)
def test_a_recording_that_ponthy_wrote_reads_back_equal(recording: Recording) -> None:
    assert equal(read(recording_parquet(recording)), recording)


@given(st.data())
def test_a_damaged_table_is_read_or_refused_and_never_worse(data: st.DataObject) -> None:
    rows = "".join(f"{i * 0.1:.1f},{i % 30}.5,49.{i:03d},6.{i:03d},{i % 3},0.2,9.8\n" for i in range(30))
    damaged = bytearray(f"t_s,speed_mps,lat_deg,lon_deg,ax_mps2,ay_mps2,az_mps2\n{rows}".encode())
    tokens = [
        b",",
        b";",
        b"\n",
        b'"',
        b"nan",
        b"1e999",
        b"\x00",
        b"\xff",
        b"-",
        b"2024-01-01",
        b"1700000000",
        b"sep=;\n",
    ]
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(damaged) - 1))
        if data.draw(st.booleans()):
            damaged[at:at] = data.draw(st.sampled_from(tokens))
        else:
            del damaged[at : at + data.draw(st.integers(0, 60))]
    try:
        recording = read(bytes(damaged))
    except SignalsError:
        return
    for name, stream in recording.signals.items():
        assert len(stream), name
        assert np.isfinite(stream.value).all(), name
        assert (np.diff(stream.t_s) > 0.0).all(), name
