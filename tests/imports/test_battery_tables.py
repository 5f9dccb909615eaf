"""A battery's tables of any make as clean records, and what is said about those that are not."""

from __future__ import annotations

import gzip
import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from app.imports.battery import read_battery
from app.science.errors import SignalsError

PLAIN = b"t_s,current_a,voltage_v\n0,0,3.3\n1,-2,3.28\n2,-2,3.279\n4,1,3.31\n"


def told(data: bytes) -> str:
    return " ".join(read_battery(data).warnings)


def test_a_plain_table_is_taken_as_it_is() -> None:
    record = read_battery(PLAIN)
    np.testing.assert_array_equal(record.t_s, [0.0, 1.0, 2.0, 4.0])
    np.testing.assert_array_equal(record.current_a, [0.0, -2.0, -2.0, 1.0])
    np.testing.assert_array_equal(record.voltage_v, [3.3, 3.28, 3.279, 3.31])
    assert record.temperature_c is None
    assert record.warnings == ()


def packed(name: str) -> bytes:
    buffer = io.BytesIO()
    if name == "zip":
        with zipfile.ZipFile(buffer, "w") as archive:
            archive.writestr("day.csv", PLAIN)
    elif name == "parquet":
        columns = np.loadtxt(io.BytesIO(PLAIN), delimiter=",", skiprows=1).T
        pq.write_table(pa.table(dict(zip(("t_s", "current_a", "voltage_v"), columns, strict=True))), buffer)
    return buffer.getvalue() or gzip.compress(PLAIN)


@pytest.mark.parametrize("form", ["gz", "zip", "parquet"])
def test_packings_hold_the_same_record(form: str) -> None:
    record, plain = read_battery(packed(form)), read_battery(PLAIN)
    np.testing.assert_array_equal(record.voltage_v, plain.voltage_v)
    np.testing.assert_array_equal(record.t_s, plain.t_s)
    assert record.warnings == ()


def test_semicolons_decimal_commas_and_units_in_names() -> None:
    data = b"Time (min);Current (mA);Voltage [mV];Temperature (K)\n0;-500,5;3300,5;298,15\n1;0;3301;299,15\n"
    record = read_battery(data)
    np.testing.assert_allclose(record.t_s, [0.0, 60.0])
    np.testing.assert_allclose(record.current_a, [-0.5005, 0.0])
    np.testing.assert_allclose(record.voltage_v, [3.3005, 3.301])
    np.testing.assert_allclose(record.temperature_c, [25.0, 26.0])
    assert "current_a is read from the column “Current (mA)”, times 0.001." in record.warnings
    assert any("kelvin" in warning for warning in record.warnings)


def test_dates_are_counted_from_the_first() -> None:
    data = b"datetime,I,V\n2026-05-01T10:00:00Z,1,3.3\n2026-05-01T10:00:02.5Z,1,3.31\n"
    record = read_battery(data)
    np.testing.assert_allclose(record.t_s, [0.0, 2.5])
    assert record.started_at_utc_s == 1777629600.0
    millis = read_battery(b"t_s,current_a,voltage_v\n1777629600000,1,3.3\n1777629602500,1,3.31\n")
    np.testing.assert_allclose(millis.t_s, [0.0, 2.5])


def test_a_signals_table_will_do() -> None:
    current = "0,battery_current_a,-2\n1,battery_current_a,-3\n"
    voltage = "0.5,battery_voltage_v,380\n1.5,battery_voltage_v,379\n"
    record = read_battery(f"t_s,signal,value\n{current}{voltage}".encode())
    np.testing.assert_allclose(record.t_s, [0.0, 0.5, 1.0, 1.5])
    np.testing.assert_allclose(record.current_a, [-2.0, -2.0, -3.0, -3.0])
    np.testing.assert_allclose(record.voltage_v, [np.nan, 380.0, np.nan, 379.0])
    wide = read_battery(b"t_s,battery_current_a,battery_voltage_v\n0,1,380\n1,1,380.1\n")
    np.testing.assert_allclose(wide.voltage_v, [380.0, 380.1])


def test_disorder_doubles_and_holes_are_mended_and_said() -> None:
    rows = ("2,1,3.3,20", "1,1,3.2,", "2,9,9,9", "3,,3.3,22", "4,1,,24", "5,1,-1,999", "x,1,3.3,20")
    record = read_battery("\n".join(("t_s,current_a,voltage_v,temperature_c", *rows)).encode())
    np.testing.assert_array_equal(record.t_s, [1.0, 2.0, 4.0, 5.0])
    np.testing.assert_array_equal(record.current_a, [1.0, 1.0, 1.0, 1.0])
    np.testing.assert_array_equal(record.voltage_v, [3.2, 3.3, np.nan, np.nan])
    np.testing.assert_allclose(record.temperature_c, [20.0, 20.0, 24.0, 24.0])
    said = " ".join(record.warnings)
    for words in (
        "1 row has no usable time",
        "1 row has no usable current",
        "went backwards once and was sorted (first: row 3)",
        "1 row has the time of an earlier one",
        "1 row has no voltage",
        "1 row has a voltage that can't be",
        "temperature",
    ):
        assert words in said


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "empty"),
        (b"\x00\x01\x02\x03", "column"),
        (b"t_s,current_a\n0,1\n1,1\n", "no column voltage_v (the voltage in volts); the table has t_s, current_a."),
        (b"t_s,voltage_v\n0,1\n1,1\n", "no column current_a"),
        (b"current_a,voltage_v\n0,1\n1,1\n", "no column t_s"),
        (b"t_s,current_a,voltage_v\n", "no row"),
        (b"t_s,current_a,voltage_v\n0,1,3.3\n", "1 row with a time and a current is left"),
        (b"t_s,current_a,voltage_v\n0,,3.3\n1,,3.3\n", "0 rows with a time and a current are left"),
        (b"t_s,current_a,voltage_v\n0,1,\n1,1,\n", "No row holds a voltage"),
        (b"t_s,current_a,voltage_v\n0,1,-3.3\n1,1,-3.3\n", "No row holds a voltage above zero"),
        (b"t_s,current_a,voltage_v\n5,1,3.3\n5,1,3.3\n", "same time"),
        (b"t_s,current_a,voltage_v\na,1,3.3\nb,1,3.3\n", "Row 2: most times"),
        (b"t_s,current_ka,voltage_v\n0,1,3.3\n1,1,3.3\n", "no column current_a"),
        (b"t_s,signal,value\n0,battery_current_a,1\n1,battery_current_a,2\n", "lacks battery_voltage_v"),
        (b"PAR1 broken", "damaged"),
        (b"PK\x03\x04 broken", "damaged"),
        (b"\x1f\x8b broken", "damaged"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_refused_in_a_sentence(data: bytes, words: str) -> None:
    with pytest.raises(SignalsError) as refused:
        read_battery(data)
    assert words in str(refused.value)


def test_tests_that_follow_each_other_are_not_shuffled_into_one() -> None:
    one = "".join(f"{t},-2,{3.6 - 0.001 * t}\n" for t in range(0, 1000, 10))
    with pytest.raises(SignalsError, match=r"Row 102: the times begin anew \(990 s, then 0 s\)"):
        read_battery(f"t_s,current_a,voltage_v\n{one}{one}".encode())
    swapped = one.splitlines(keepends=True)
    later_half_first = "".join(swapped[50:] + swapped[:50])
    assert "sorted" in told(f"t_s,current_a,voltage_v\n{later_half_first}".encode())


def test_real_laboratory_files_are_read(shared_data: Callable[[str], Path]) -> None:
    record = read_battery(shared_data("leaf-cell-ecm") / "cell-discharge-bitrode-1c.csv.gz")
    assert record.t_s[0] == 1.0
    assert record.warnings[0] == "Columns not used: cap_ah, step, mode."
    assert "count of charge" in record.warnings[1]
    with pytest.raises(SignalsError, match="begin anew"):
        read_battery(shared_data("nasa-b0018-aging") / "B0018_discharge.csv.gz")
