"""Several files of one trip in a ZIP archive."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from app.imports import signals
from app.imports.detect import detect_format, explain_unknown
from app.imports.signals import read_signals
from app.science.errors import SignalsError

OBD = b"t_s,speed_mps\n1,10\n2,11\n3,12\n"
GNSS = b"t_s,lat_deg,lon_deg\n1.5,49,6\n2.5,49.1,6\n"


def archive(**members: bytes) -> bytes:
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED) as out:
        for name, content in members.items():
            out.writestr(name.replace("__", "/").replace("_DOT_", "."), content)
    return sink.getvalue()


def test_the_files_of_an_archive_make_one_trip() -> None:
    data = archive(trip__obd_DOT_csv=OBD, trip__gnss_DOT_csv=GNSS, README_DOT_txt=b"Hello, there\n")
    assert detect_format(data[:65536], "trip.zip") == "signals"
    recording = read_signals(data, filename="trip.zip")
    assert set(recording) == {"speed_mps", "lat_deg", "lon_deg"}
    assert recording["lat_deg"].t_s.tolist() == [1.5, 2.5]
    assert recording.warnings == ()


def test_a_file_that_can_not_be_used_is_left_out_as_long_as_another_can() -> None:
    recording = read_signals(archive(a_DOT_csv=OBD, b_DOT_csv=b"x,y\n1,2\n"), filename="trip.zip")
    assert set(recording) == {"speed_mps"}
    assert recording.warnings[0].startswith("b.csv can't be used: There is no column of times")
    with pytest.raises(SignalsError, match=r"b\.csv can't be used") as caught:
        read_signals(archive(b_DOT_csv=b"x,y\n1,2\n"), filename="trip.zip")
    assert (caught.value.row, caught.value.field) == (1, "t_s")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (archive(a_DOT_csv=OBD)[:60], "damaged or breaks off"),
        (archive(doc_DOT_kml=b"<kml/>"), "holds no table"),
        (archive(a_DOT_csv=archive(a_DOT_csv=OBD)), "can't be used"),
    ],
    ids=["torn", "no-table", "nested"],
)
def test_an_archive_without_use_is_refused(data: bytes, words: str) -> None:
    with pytest.raises(SignalsError, match=words):
        read_signals(data, filename="trip.zip")


def test_a_bomb_is_not_unpacked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(signals, "LARGEST_BYTES", 1_000_000)
    with pytest.raises(SignalsError, match="1 tables of 5 MB"):
        read_signals(archive(a_DOT_csv=b"0" * 5_000_000), filename="trip.zip")
    with pytest.raises(SignalsError, match="51 tables"):
        read_signals(archive(**{f"a{i}_DOT_csv": OBD for i in range(51)}), filename="trip.zip")


def test_an_office_file_is_no_archive_of_tables() -> None:
    sheet = archive(Content_Types_DOT_xml=b"<Types/>", xl__sheet_DOT_xml=b"<x/>")
    assert detect_format(sheet, "drive.xlsx") == "unknown"
    assert "Excel" in explain_unknown(sheet, "drive.xlsx")


def test_car_3ba1_goes_up_as_one_archive(shared_data: Callable[[str], Path]) -> None:
    folder = shared_data("canedge-obd-imu-gnss")
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w") as out:
        for file in sorted(folder.glob("car3BA1_*.csv.gz")):
            out.write(file, file.name)
    recording = read_signals(sink.getvalue(), filename="3BA1.zip")
    assert {"speed_mps", "lat_deg", "ax_mps2", "gz_radps"} <= set(recording)
    assert recording.started_at_utc_s == pytest.approx(1_627_305_212, abs=1.0)
