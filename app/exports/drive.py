"""The trajectory of a drive as a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from app.exports.csv import table_csv
from app.exports.parquet import table_parquet
from app.science.arrays import FloatArray
from app.science.errors import TooLittleData


def drive_csv(answer: Mapping[str, Any]) -> bytes:
    """Write the trajectory with its costates, one row for each time."""
    return table_csv(_columns(answer))


def drive_parquet(answer: Mapping[str, Any]) -> bytes:
    """Write the same as Parquet; where it came from lies in the file's metadata."""
    return table_parquet(_columns(answer), {"provenance": answer.get("provenance")})


def _columns(answer: Mapping[str, Any]) -> dict[str, FloatArray]:
    trajectory = answer.get("trajectory")
    if not trajectory:
        raise TooLittleData("This drive has no trajectory; save it as json.")
    length = len(next(iter(trajectory.values())))
    beside = {f"costate_{name}": values for name, values in (answer.get("costates") or {}).items()}
    every = trajectory | beside
    return {name: np.array(values, np.float64) for name, values in every.items() if len(values) == length}
