"""``./ponthy battery-ageing``: histories as people and the service write them, and its exit status."""

from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from app.cli.main import main
from app.imports.battery_history import read_history, read_tests

FADE_PER_YEAR = 0.05


def history(folder: Path, *, dates: bool) -> str:
    rng = np.random.default_rng(1)
    begin = datetime(2025, 1, 1, 12, tzinfo=UTC)
    lines = ["ended_at,capacity_ah,capacity_ah_sd,charge_ah,follows_id" if dates else "at_days;capacity_ah"]
    for day in range(0, 730, 10):
        capacity = 30.0 * (1.0 - FADE_PER_YEAR * day / 365.25) + 0.1 * rng.standard_normal()
        if dates:
            follows = "" if day % 20 == 0 else "6f1c2f0b"
            lines.append(f"{(begin + timedelta(days=day)).isoformat()},{capacity:.4f},0.1,20.0,{follows}")
        else:
            lines.append(f"{day};{capacity:.4f}".replace(".", ","))
    file = folder / "history.csv"
    file.write_text("\n".join([*lines, ""]))
    return str(file)


def test_a_history_is_answered_with_slope_and_life(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = history(tmp_path, dates=False)
    assert main(["battery-ageing", file, "--rated-ah", "30", "--threshold", "0.85", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    trend, left = answer["capacity"]["trend"], answer["capacity"]["remaining"]
    assert trend["slope_share_per_year"] == pytest.approx(-FADE_PER_YEAR, abs=3.0 * trend["slope_share_per_year_sd"])
    truth = 0.15 / FADE_PER_YEAR * 365.25 - 720.0
    assert left["remaining_low_days"] < truth
    assert left["remaining_days"] == pytest.approx(truth, rel=0.25)
    assert answer["resistance"]["trend"] is None


def test_people_get_a_table_with_their_tests_beside(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tests = tmp_path / "tests.csv"
    tests.write_text("at,capacity_ah,capacity_ah_sd\n2025-07-01,29.3,0.1\n2026-07-01,24.0,0.1\n")
    assert main(["battery-ageing", history(tmp_path, dates=True), "--rated-ah", "30", "--tests", str(tests)]) == 0
    told = capsys.readouterr().out
    assert "capacity, Ah" in told
    assert "no trend" in told
    assert "test at day 20635.0: 24 ± 0.1 Ah, -" in told
    assert "laboratory's test says" in told


def test_an_exported_history_tells_which_rows_took_over(tmp_path: Path) -> None:
    points = read_history(Path(history(tmp_path, dates=True)).read_bytes())
    assert [one.carried for one in points[:4]] == [False, True, False, True]
    assert points[1].at - points[0].at == pytest.approx(10.0)
    assert points[0].charge_ah == 20.0
    assert np.isnan(points[0].resistance_ohm)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,capacity_ah\n1,2\n", "lacks a time"),
        ("at_days,q\n1,2\n", "lacks the column capacity_ah"),
        ("at_days,capacity_ah\n1,-2\n", "Row 2: a capacity of -2 Ah"),
        ("at_days,capacity_ah,capacity_ah_sd\n1,2,0\n", "Row 2: capacity_ah_sd is 0"),
        ("at_days,capacity_ah\nx,y\n", "No row has both"),
    ],
)
def test_what_is_no_history_is_refused_on_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, words: str
) -> None:
    file = tmp_path / "history.csv"
    file.write_text(text)
    assert main(["battery-ageing", str(file)]) == 1
    told = capsys.readouterr()
    assert words in told.err
    assert told.out == ""
    assert main(["battery-ageing", history(tmp_path, dates=False), "--threshold", "80"]) == 1
    assert "threshold: 80 is no share" in capsys.readouterr().err


def test_tests_without_a_standard_deviation_are_taken_to_one_percent() -> None:
    (test,) = read_tests(b"at_days,capacity_ah\n3,2.0\n")
    assert (test.at, test.capacity_ah) == (3.0, 2.0)
    assert test.sd_ah == pytest.approx(0.02)
