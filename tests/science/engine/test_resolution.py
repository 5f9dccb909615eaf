"""Sparse points in coarser cells."""

from __future__ import annotations

import numpy as np

from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.points import OperatingPoints
from app.science.engine.resolution import resolve
from app.science.vehicle.model import Vehicle


def test_scattered_points_of_a_polled_bus_are_trusted_by_the_error_of_their_mean() -> None:
    rng = np.random.default_rng(3)
    n = 160
    rpm, nm = rng.uniform(1400, 1900, n), rng.uniform(40, 100, n)
    efficiency = 0.35 + 0.09 * rng.standard_normal(n)
    power = rpm * np.pi / 30 * nm
    points = OperatingPoints(
        np.arange(n) * 7.0, rpm, nm, power, power / efficiency, efficiency, np.full(n, 0.01), "ecu"
    )
    fine = CellGrid()
    resolved = resolve(accumulate(points, fine), fine)
    assert resolved.grid.independent
    assert resolved.grid.rpm > fine.rpm
    cells = build_map(resolved.sums, resolved.grid, Vehicle())
    trusted = np.isfinite(cells.efficiency)
    assert trusted.sum() >= 4
    assert (cells.sd[trusted] / np.sqrt(cells.n[trusted]) <= 0.05).all()
    assert abs(np.average(cells.efficiency[trusted], weights=cells.n[trusted]) - 0.35) < 0.03
