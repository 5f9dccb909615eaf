"""Arrays as short JSON numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.science.arrays import FloatArray


def rounded(values: FloatArray, decimals: int) -> list[Any]:
    """Return a (nested) list rounded to ``decimals``; what is not finite becomes None."""
    values = np.asarray(values, dtype=np.float64)
    known = np.isfinite(values)
    if decimals <= 0:
        whole = np.round(np.where(known, values, 0.0), decimals).astype(np.int64)
        short: Any = whole
    else:
        short = np.round(values, decimals)
    if known.all():
        return list(short.tolist())
    with_gaps = short.astype(object)
    with_gaps[~known] = None
    return list(with_gaps.tolist())


def thousands(number: int) -> str:
    """Return a whole number with thin spaces between groups of three digits."""
    return f"{number:,}".replace(",", "\u202f")
