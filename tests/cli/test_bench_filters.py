"""The table of all filters: one line each, with the errors that the truth says, and the default as measure."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.cli.bench import filters
from app.cli.bench.command import tables
from app.science.virtualcar.simulate import simulate


def test_every_filter_gets_its_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(filters, "simulate", lambda wanted: simulate(replace(wanted, duration_s=120.0)))
    monkeypatch.setattr(filters, "FRESH_SEEDS", (1,))
    monkeypatch.setattr(filters, "DENSE_FROM", 4000)
    monkeypatch.setattr(filters, "DENSE_EVENTS", 300)
    monkeypatch.setattr(filters, "VARIANTS", [v for v in filters.VARIANTS if v.name in ("ekf", "sr-ekf", "ukf")])
    figures = filters.measure()
    (table,) = tables({"filters": figures})
    assert {len(line) for line in table} == {13}
    assert [line[0] for line in table[1:]] == [
        "ekf, smoothed", "ekf, filtered", "sr-ekf, smoothed", "sr-ekf, filtered", "ukf, smoothed", "ukf, filtered",
    ]  # fmt: skip
    by_name = {one.name: one for one in figures}
    assert by_name["ekf, smoothed: per event beside the default"].ratio == 1.0
    assert by_name["ekf, filtered: speed"].value > by_name["ekf, smoothed: speed"].value
    assert by_name["sr-ekf, smoothed: thrust"].value == pytest.approx(by_name["ekf, smoothed: thrust"].value, rel=1e-4)
    assert by_name["ukf, smoothed: per event"].value > by_name["ekf, smoothed: per event"].value
