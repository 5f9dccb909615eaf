"""What the sensors of a trip tell, as JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from app.science.observer.observability.report import TripObservability
from app.science.observer.states import STATE_COLUMNS

DIGITS = 4


def observability_json(found: TripObservability) -> bytes:
    """Return what the sensors of a trip tell, by the names of its columns, as a JSON document."""
    document: dict[str, Any] = {
        "sensors": list(found.sensors),
        "measurements": list(found.measurements),
        "losses": [
            {
                "lost": list(loss.lost),
                "words": words,
                "moving": dict(zip(STATE_COLUMNS, loss.told.moving, strict=True)),
                "standing": dict(zip(STATE_COLUMNS, loss.told.standing.tolist(), strict=True)),
            }
            for loss, words in zip(found.losses, found.words, strict=True)
        ],
        "window_s": found.window_s,
        "begin_s": [round(float(t), 3) for t in found.begin_s],
        "states": {
            column: {
                "prior_sd": float(found.prior_sd[i]),
                "median_sd": _short(float(np.median(found.sd[:, i]))),
                "told_share": _short(float(found.told_share[i])),
                "sd": [_short(float(value)) for value in found.sd[:, i]],
            }
            for i, column in enumerate(STATE_COLUMNS)
        },
    }
    return json.dumps(document, separators=(",", ":"), allow_nan=False).encode()


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
