"""Which files are one trip and which are several."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.cli.inputs import InputFormat, recordings
from app.science.errors import SignalsError
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation


def table(path: Path, columns: str) -> Path:
    rows = [f"{t},{','.join(str(t % 7 + 1) for _ in columns.split(','))}" for t in range(100)]
    path.write_text("\n".join([f"t_s,{columns}", *rows]))
    return path


def test_tables_without_a_common_signal_are_one_trip(tmp_path: Path) -> None:
    engine = table(tmp_path / "engine.csv", "engine_speed_rpm,fuel_rate_lph")
    receiver = table(tmp_path / "receiver.csv", "lat_deg,lon_deg,hdop")
    body = table(tmp_path / "body.csv", "speed_mps,hdop")
    (trip,) = recordings([engine, receiver, body])
    assert trip.name == "engine.csv + receiver.csv + body.csv"
    assert set(trip.recording) == {"engine_speed_rpm", "fuel_rate_lph", "lat_deg", "lon_deg", "hdop", "speed_mps"}


def test_tables_with_a_common_signal_are_several_trips(tmp_path: Path) -> None:
    first = [table(tmp_path / "1.csv", "speed_mps"), table(tmp_path / "1b.csv", "fuel_rate_lph")]
    second = [table(tmp_path / "2.csv", "speed_mps"), table(tmp_path / "2b.csv", "fuel_rate_lph")]
    assert [trip.name for trip in recordings([*first, *second])] == ["1.csv + 1b.csv", "2.csv + 2b.csv"]


def test_an_image_between_tables_keeps_them_apart(tmp_path: Path) -> None:
    image = tmp_path / "trip.dat"
    image.write_bytes(simulate(Simulation(duration_s=60.0)).image)
    files = [table(tmp_path / "1.csv", "speed_mps"), image, table(tmp_path / "2.csv", "fuel_rate_lph")]
    assert [trip.name for trip in recordings(files)] == ["1.csv", "trip.dat", "2.csv"]


def test_two_cars_of_one_day_stay_two_trips(tmp_path: Path) -> None:
    paths = []
    for name, start, column in (("a", 1.6e9, "speed_mps"), ("b", None, "fuel_rate_lph")):
        path = tmp_path / f"{name}.csv"
        path.write_text("\n".join([f"t_s,{column}", *(f"{(start or 0) + t},{t}" for t in range(50))]))
        paths.append(path)
    assert [trip.name for trip in recordings(paths)] == ["a.csv", "b.csv"]


@pytest.mark.parametrize(
    ("content", "words"),
    [("lat_deg,lon_deg,alt_m,way\n1,2,3,4\n", "elevation"), ("<ponthy_config/>", "car xml"), ("hello", "hello")],
)
def test_a_file_of_another_kind_is_named(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "hello.csv"
    path.write_text(content)
    with pytest.raises(SignalsError, match=words):
        list(recordings([path]))
    with pytest.raises(SignalsError):
        list(recordings([path], InputFormat.SIGNALS))
