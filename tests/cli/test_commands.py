"""Commands as they are called: their words, their files, their exit status."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from app.cli.main import main
from app.cli.process import SENSORS
from app.science.observer.observe import SENSOR_SIGNALS
from app.science.observer.states import DERIVED_COLUMNS, STATE_COLUMNS
from app.science.vehicle.xml import read_vehicle

Capture = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six minutes of the virtual car, simulated by the command."""
    folder = tmp_path_factory.mktemp("drive")
    assert main(["simulate", str(folder), "--minutes", "6", "--seed", "11"]) == 0
    return folder


def processed(drive: Path, out: Path, *options: str, files: list[Path] | None = None) -> dict[str, object]:
    names = [str(path) for path in files or [drive / "trip.dat"]]
    assert main(["process", *names, "--car", str(drive / "car.xml"), "--out", str(out), *options]) == 0
    summary: dict[str, object] = json.loads((out / "summary.json").read_text())
    return summary


def test_simulate_writes_the_same_bytes_for_the_same_seed(drive: Path, tmp_path: Path) -> None:
    assert main(["simulate", str(tmp_path), "--minutes", "6", "--seed", "11"]) == 0
    names = ["car.xml", "elevation.csv", "trip.dat", "truth.json", "truth.parquet"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    assert all((tmp_path / name).read_bytes() == (drive / name).read_bytes() for name in names)


def test_a_car_that_was_given_keeps_all_its_xml_says(drive: Path, tmp_path: Path) -> None:
    strange = (drive / "car.xml").read_bytes().replace(b"<drag>", b'<trailer axles="2"><!-- blue --></trailer><drag>')
    (tmp_path / "strange.xml").write_bytes(strange)
    words = ["simulate", str(tmp_path / "out"), "--minutes", "2", "--car", str(tmp_path / "strange.xml")]
    assert main(words) == 0
    written = (tmp_path / "out" / "car.xml").read_bytes()
    assert b'<trailer axles="2"><!-- blue --></trailer>' in written
    assert read_vehicle(written) == read_vehicle(strange)
    assert main([*words[:-1], str(tmp_path / "out" / "car.xml")]) == 0
    assert (tmp_path / "out" / "car.xml").read_bytes() == written


def test_an_image_without_a_drive_is_reported_on_before_the_error(drive: Path, tmp_path: Path, capsys: Capture) -> None:
    image = bytearray((drive / "trip.dat").read_bytes()[:40])
    image[20:] = b"noise" * 100
    (tmp_path / "broken.dat").write_bytes(image)
    capsys.readouterr()
    assert main(["decode", str(tmp_path / "broken.dat"), "--out", str(tmp_path / "out"), "--json"]) == 1
    said = capsys.readouterr()
    report = json.loads(said.out)
    assert report == json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["bytes"] == len(image)
    assert report["skipped_bytes"] >= 500
    assert said.err.startswith("ponthy: ")
    assert main(["decode", str(tmp_path / "broken.dat")]) == 1
    first = report["resyncs"][0]
    assert f"skipped: {first['skipped_bytes']} bytes at {first['offset']}" in capsys.readouterr().out


def test_truth_has_the_states_columns(drive: Path) -> None:
    assert pq.read_schema(drive / "truth.parquet").names == ["t_s", *STATE_COLUMNS, *DERIVED_COLUMNS]


def test_decode_reports_and_its_tables_process_alike(drive: Path, tmp_path: Path, capsys: Capture) -> None:
    assert main(["decode", str(drive / "trip.dat"), "--out", str(tmp_path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report == json.loads((tmp_path / "report.json").read_text())
    assert report["bytes"] == (drive / "trip.dat").stat().st_size
    assert report["packets"]["accelerometer"] == 6 * 60 * 40 + 1

    elevation = ("--elevation", str(drive / "elevation.csv"))
    direct = processed(drive, tmp_path / "direct", *elevation)
    through = processed(drive, tmp_path / "through", *elevation, files=[tmp_path / "trip-1.parquet"])
    assert direct["distance_m"] == through["distance_m"]
    assert (tmp_path / "direct" / "states.parquet").read_bytes() == (
        tmp_path / "through" / "states.parquet"
    ).read_bytes()


def test_process_writes_what_the_contract_names(drive: Path, tmp_path: Path, capsys: Capture) -> None:
    capsys.readouterr()
    written = processed(drive, tmp_path, "--json")
    assert json.loads(capsys.readouterr().out) == written
    assert {"events", "duration_s", "distance_m", "fuel_energy_j", "fuel_l", "filter", "tuning", "nis", "verdict"} <= (
        written.keys()
    )
    assert {"warnings", "timing_s"} <= written.keys()

    names = pq.read_schema(tmp_path / "states.parquet").names
    both = [name for state in STATE_COLUMNS for name in (state, f"{state}_sd")]
    assert set(names) == {"t_s", *both, *DERIVED_COLUMNS}
    assert names[0] == "t_s"

    document = json.loads((tmp_path / "map.json").read_text())
    assert (document["cell"]["rpm"], document["cell"]["nm"]) == (50, 2)
    assert {"rpm", "nm", "n", "efficiency", "sd", "bsfc_gpkwh"} == document["cells"][0].keys()
    assert document["provenance"]["elevation_sha256"], "elevation.csv beside the image is taken without being named"


def test_process_comes_near_the_truth(drive: Path, tmp_path: Path) -> None:
    written = processed(drive, tmp_path)
    truth = json.loads((drive / "truth.json").read_text())
    assert written["distance_m"] == pytest.approx(truth["distance_m"], rel=2e-3)
    assert written["fuel_l"] == pytest.approx(truth["fuel_l"], rel=2e-2)


def test_trips_of_several_files_make_one_map(drive: Path, tmp_path: Path) -> None:
    once = processed(drive, tmp_path / "once")
    copy = shutil.copy(drive / "trip.dat", drive / "again.dat")
    twice = processed(drive, tmp_path / "twice", files=[drive / "trip.dat", Path(copy)])

    assert [trip["states"] for trip in twice["trips"]] == ["states.parquet", "states-2.parquet"]  # type: ignore[attr-defined]
    assert twice["operating_points"] == 2 * once["operating_points"]  # type: ignore[operator]
    points = pq.read_table(tmp_path / "twice" / "operating_points.parquet")
    assert np.bincount(points["trip"].to_numpy()).tolist() == [0, *[once["operating_points"]] * 2]
    maps = [json.loads((tmp_path / name / "map.json").read_text()) for name in ("once", "twice")]
    counts = [sum(cell["n"] for cell in one["cells"]) for one in maps]
    assert counts == [once["operating_points"], twice["operating_points"]]


def test_options_reach_the_observer(drive: Path, tmp_path: Path) -> None:
    (tmp_path / "stiff.json").write_text('{"q_thrust": 1e4}')
    plain = processed(drive, tmp_path / "a", "--no-smooth", "--tuning", str(tmp_path / "stiff.json"))
    assert (plain["smoothed"], plain["tuning"]) == (False, "stiff")
    bare = processed(drive, tmp_path / "b", "--without", "gps,dem,acc", "--tuning", "thesis-2010")
    sensors = bare["trips"][0]["sensors"]  # type: ignore[index]
    assert not [name for name in sensors if name.startswith(("gps", "road", "acc"))]
    provenance = json.loads((tmp_path / "b" / "map.json").read_text())["provenance"]
    assert (provenance["without"], provenance["elevation_sha256"]) == (["acc", "dem", "gps"], None)


@pytest.mark.parametrize(
    ("tuning", "said"),
    [
        ('{"q_thrust": -1}', "bad.json: q_thrust: -1 can't be a covariance; it must be above zero."),
        ('{"q_thurst": 1}', "bad.json: q_thurst: no such entry in a tuning. Did you mean q_thrust?"),
        ("{", "bad.json: line 1: this is not JSON"),
        ('{"q_thrust": 1e300, "unsteady_boost": 1e10}', "stopped being finite at "),
    ],
)
def test_a_bad_tuning_is_answered_with_1_and_earlier_results_stay(
    tuning: str, said: str, drive: Path, tmp_path: Path, capsys: Capture
) -> None:
    out = tmp_path / "out"
    processed(drive, out, "--no-smooth")
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    (tmp_path / "bad.json").write_text(tuning)
    words = ["process", str(drive / "trip.dat"), "--car", str(drive / "car.xml"), "--out", str(out)]
    capsys.readouterr()
    assert main([*words, "--tuning", str(tmp_path / "bad.json")]) == 1
    assert said in capsys.readouterr().err.splitlines()[-1]
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_every_sensor_that_can_be_left_out_is_offered() -> None:
    assert set(SENSORS) == set(SENSOR_SIGNALS)


WRONG_WORDS = [
    [],
    ["nothing-like-this"],
    ["decode"],
    ["decode", "no-such-file.dat"],
    ["simulate", "{tmp}/x", "--minutes", "soon"],
    ["simulate", "{tmp}/x", "--route", "moon"],
    ["process", "{drive}/trip.dat", "--out", "{tmp}/x"],
    ["process", "{drive}/trip.dat", "--car", "{drive}/car.xml", "--out", "{tmp}/x", "--without", "gps,radar"],
    ["process", "{drive}/trip.dat", "--car", "{drive}/car.xml", "--out", "{tmp}/x", "--filter", "magic"],
    ["process", "{drive}/trip.dat", "--car", "{drive}/car.xml", "--out", "{tmp}/x", "--tuning", "no-such"],
    ["bench", "no-such-benchmark"],
    ["upload", "{drive}/trip.dat", "--car", "1", "--url", "localhost"],
    ["upload", "{drive}/trip.dat", "--url", "http://localhost:1"],
]


@pytest.mark.parametrize("words", WRONG_WORDS, ids=" ".join)
def test_wrong_words_are_answered_with_2_and_one_line(
    words: list[str], drive: Path, tmp_path: Path, capsys: Capture
) -> None:
    capsys.readouterr()
    assert main([word.format(tmp=tmp_path, drive=drive) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert said.err.startswith("ponthy: ")


@pytest.mark.parametrize("content", [b"", b"\0" * 100_000, b"not a log at all\n" * 99, bytes(range(256)) * 400])
def test_hopeless_files_are_answered_with_1_and_one_line(
    content: bytes, drive: Path, tmp_path: Path, capsys: Capture
) -> None:
    bad = tmp_path / "bad.dat"
    bad.write_bytes(content)
    for words in (
        ["decode", str(bad)],
        ["process", str(bad), "--car", str(drive / "car.xml"), "--out", str(tmp_path / "out")],
        ["process", str(drive / "trip.dat"), "--car", str(bad), "--out", str(tmp_path / "out")],
    ):
        capsys.readouterr()
        assert main(words) == 1, words
        said = capsys.readouterr()
        assert ("bytes" in said.out) == (words[0] == "decode")
        assert said.err.splitlines()[-1].startswith("ponthy: ")
        assert "Traceback" not in said.err
        assert "PONTHY_DEBUG" not in said.err, "an error that was foreseen"


def test_debug_shows_where_it_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bad = tmp_path / "bad.dat"
    bad.write_bytes(b"")
    monkeypatch.setenv("PONTHY_DEBUG", "1")
    with pytest.raises(ValueError, match=r"."):
        main(["decode", str(bad)])
