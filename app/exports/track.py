"""The way a trip took, thin enough for map programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import TooLittleData


@dataclass(frozen=True, slots=True)
class Track:
    """Positions in the order of time, arrays of shape (n,), n at least 2; altitude is 0 where unknown."""

    t_s: FloatArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    alt_m: FloatArray
    speed_mps: FloatArray


def track(columns: Mapping[str, FloatArray], step_s: float) -> Track:
    """Take a position about every ``step_s`` seconds, the first and the last known one included.

    Parameters
    ----------
    columns : mapping of str to array, shape (n,)
        ``t_s``, ``lat_deg``, ``lon_deg``, ``alt_m`` and ``speed_mps``.
    step_s : float

    Raises
    ------
    TooLittleData
        When fewer than two positions are known.
    """
    known = np.flatnonzero(np.isfinite(columns["lat_deg"]) & np.isfinite(columns["lon_deg"]))
    if len(known) < 2:
        raise TooLittleData(
            "No position is known for this trip, so it can't be put on a map; export it as CSV instead."
        )
    t = columns["t_s"][known]
    wanted = np.searchsorted(t, np.arange(t[0], t[-1], step_s))
    kept = known[np.unique(np.append(wanted, len(known) - 1))]
    return Track(
        t_s=columns["t_s"][kept],
        lat_deg=columns["lat_deg"][kept],
        lon_deg=columns["lon_deg"][kept],
        alt_m=np.nan_to_num(columns["alt_m"][kept]),
        speed_mps=np.nan_to_num(columns["speed_mps"][kept]),
    )
