"""Warming compiles everything a trip needs, once per version of the science."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.science.fingerprint import science_fingerprint
from app.science.logger.decode import decode_image
from app.science.observer.family.filter import filter_family
from app.science.observer.family.methods import FILTERS
from app.science.observer.observe import observe
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation
from workers import warming


def test_warming_is_done_once_per_version(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert warming.warm() == 0
    assert (tmp_path / science_fingerprint() / "warm").exists()
    monkeypatch.setattr(warming, "simulate", lambda _spec: pytest.fail("warmed twice"))
    assert warming.warm() == 0


def test_all_filters_are_compiled_by_trying_one(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """They are one kernel with a number for the filter, so one of them compiles all."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(warming.os, "nice", lambda _step: 0)
    assert warming.warm_filters() == 0
    assert (tmp_path / science_fingerprint() / "warm-filters").exists()
    compiled = len(filter_family.signatures)
    trip = simulate(Simulation(duration_s=60.0, seed=8))
    recording = decode_image(trip.image).recordings[0]
    for name in FILTERS:
        assert observe(recording, trip.vehicle, filter=name).filter == name
    assert len(filter_family.signatures) == compiled
