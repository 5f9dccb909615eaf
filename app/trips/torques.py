"""A trip whose engine reports its torque, observed once more without it, so that the two can be compared."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import structlog

from app.science.engine.operating import DEFAULT_RULES
from app.science.engine.torque_sources import torque_sources, words
from app.science.errors import ScienceError
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

REPORTED = "engine_torque_nm"

log = structlog.get_logger(__name__)


def torque_document(
    recording: Recording, vehicle: Vehicle, observe_alone: Callable[[Recording], Observation]
) -> bytes | None:
    """Return the comparison as a file; None where the engine reports no torque, or too little of it.

    Parameters
    ----------
    recording : Recording
    vehicle : Vehicle
    observe_alone : callable
        Runs the observer on the measurements without the reported torque.
    """
    if REPORTED not in recording:
        return None
    others = replace(recording, signals={name: one for name, one in recording.signals.items() if name != REPORTED})
    try:
        found = torque_sources(observe_alone(others), recording, vehicle, DEFAULT_RULES)
    except ScienceError as error:
        log.info("torques not compared", reason=str(error))  # the trip itself has its result
        return None
    return json.dumps(_plain(asdict(found)) | {"words": words(found)}).encode()


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    return value
