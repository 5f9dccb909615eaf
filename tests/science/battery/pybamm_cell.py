"""The example cell of PyBaMM, 100 Ah, from its published tables."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.curve import OpenCircuit
from app.science.battery.virtual.tables import TableCell


def pybamm_cell(folder: Path) -> TableCell:
    """Read the cell; in its tables currents are positive when discharging."""

    def table(name: str) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        rows = np.loadtxt(folder / f"ecm_example_{name}.csv", delimiter=",", skiprows=1)
        axes = [np.unique(rows[:, k]) for k in range(3)]
        cube = rows[np.lexsort(rows[:, 2::-1].T), 3].reshape([len(axis) for axis in axes])
        return axes[0], -axes[1][::-1], axes[2], np.ascontiguousarray(cube[:, ::-1])

    with (folder / "ecm_example_ocv.csv").open(encoding="utf-8") as file:
        points = tuple((float(row[0]), float(row[1])) for row in csv.reader(file) if not row[0].startswith("#"))
    temperature, current, soc, series = table("r0")
    return TableCell(
        OpenCircuit(points=points), 100.0, temperature, current, soc, series, table("r1")[3], table("c1")[3]
    )
