"""Child processes come back when they die, after pauses that grow."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import pytest

from app.settings import Settings
from workers.children import LONGEST_PAUSE_S, Child
from workers.supervisor import environment_of


def test_a_child_that_dies_is_started_again_after_growing_pauses(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    diary = tmp_path / "diary"
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\necho $(date +%s.%N) >> {diary}\nexit 3\n")
    program.chmod(0o700)
    monkeypatch.setattr(sys, "executable", str(program))
    child = Child("test", [], {})
    end = time.monotonic() + 20
    while (not diary.exists() or len(diary.read_text().split()) < 3) and time.monotonic() < end:
        child.keep_running()
        time.sleep(0.01)
    child.stop(time.monotonic() + 5)
    first, second, third = map(float, diary.read_text().split()[:3])
    assert 0.9 <= second - first < third - second <= LONGEST_PAUSE_S


def test_children_get_the_very_settings(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    settings = Settings(
        data_dir=tmp_path, lease_s=2.5, auth=True, broker_url="redis://:secret@localhost/1", tiles_attribution="© them"
    )
    for name, value in environment_of(settings).items():
        monkeypatch.setenv(name, value)
    assert Settings() == settings
