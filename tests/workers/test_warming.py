"""Warming compiles everything a trip needs, once per version of the science."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.science.fingerprint import science_fingerprint
from workers import warming


def test_warming_is_done_once_per_version(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert warming.warm() == 0
    assert (tmp_path / science_fingerprint() / "warm").exists()
    monkeypatch.setattr(warming, "simulate", lambda _spec: pytest.fail("warmed twice"))
    assert warming.warm() == 0
