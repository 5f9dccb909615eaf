"""Real cells as records: a Leaf's from a cycler, NASA's ageing one, discharge by discharge."""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

import numpy as np

from app.science.battery.laboratory import held_from_logged
from app.science.battery.record import BatteryRecord


def leaf_record(folder: Path, name: str) -> BatteryRecord:
    with gzip.open(folder / f"{name}.csv.gz", "rt", encoding="utf-8") as file:
        rows = [[float(row[key]) for key in ("t_s", "current_a", "voltage_v")] for row in csv.DictReader(file)]
    t_s, current_a, voltage_v = np.array(rows).T
    return held_from_logged(BatteryRecord(t_s, current_a, voltage_v))


def leaf_counter_ah(folder: Path, name: str, mode: str) -> float:
    """Return the largest count of the cycler's own counter in steps of a mode."""
    with gzip.open(folder / f"{name}.csv.gz", "rt", encoding="utf-8") as file:
        return max(abs(float(row["cap_ah"])) for row in csv.DictReader(file) if row["mode"] == mode)


def nasa_discharges(folder: Path) -> dict[int, tuple[BatteryRecord, float]]:
    """Return each discharge with the capacity down to 2.7 V that its file tells, by cycle."""
    with gzip.open(folder / "B0018_discharge.csv.gz", "rt", encoding="utf-8") as file:
        rows = np.array([[float(value) for value in row[:6]] for row in list(csv.reader(file))[1:]])
    found = {}
    for cycle in np.unique(rows[:, 0]):
        _, t_s, voltage_v, current_a, temperature_c, capacity_ah = rows[rows[:, 0] == cycle].T
        record = held_from_logged(BatteryRecord(t_s, current_a, voltage_v, temperature_c))
        found[int(cycle)] = record, float(capacity_ah[0])
    return found
