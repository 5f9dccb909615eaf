"""Sensor losses in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.science.arrays import BoolArray
from app.science.observer.observability.losses import Loss
from app.science.observer.states import State

STATE_WORDS: dict[State, str] = {
    State.DISTANCE: "distance",
    State.SPEED: "speed",
    State.THRUST: "thrust",
    State.HEADING: "heading",
    State.PITCH: "pitch",
    State.NORTH: "north",
    State.EAST: "east",
    State.DOWN: "height",
    State.CURVATURE_H: "the road's bends",
    State.CURVATURE_V: "the road's crests and dips",
    State.FUEL_ENERGY: "fuel burnt",
    State.FUEL_POWER: "fuel power",
    State.ENGINE_ANGLE: "engine turns",
    State.ENGINE_SPEED: "engine speed",
    State.BIAS_I: "the accelerometer's bias forward",
    State.BIAS_J: "the accelerometer's bias sideways",
    State.BIAS_K: "the accelerometer's bias down",
}

SENSOR_WORDS: dict[str, str] = {
    "vss": "wheel ticks",
    "speed": "the reported speed",
    "acc": "the accelerometer",
    "gps": "satellite positions",
    "dem": "road heights",
    "fuel": "the fuel measurement",
    "engine": "the engine's turns",
    "heading": "the course",
    "pitch": "the measured pitch",
    "yaw_rate": "the gyroscope",
    "curvature_h": "the road's curvature",
    "engine_torque": "the reported torque",
}

ONLY = "only while speed, direction and slope change"
BIASES = [State.BIAS_I, State.BIAS_J, State.BIAS_K]
ALL_BIASES = "the accelerometer's biases"
PLURALS = {ALL_BIASES, *(STATE_WORDS[state] for state in (State.CURVATURE_H, State.CURVATURE_V, State.ENGINE_ANGLE))}


def words_of(losses: Sequence[Loss]) -> tuple[str, ...]:
    """Return a sentence for each loss; those of a lost sensor tell what it takes from the whole set."""
    whole = losses[0].told
    return tuple(_whole(loss) if not loss.lost else _lost(loss, whole.steady, whole.changing) for loss in losses)


def _whole(loss: Loss) -> str:
    never = _named(~loss.told.changing)
    sometimes = _named(loss.told.changing & ~loss.told.steady)
    if not never and not sometimes:
        return "With all its sensors, everything is told while the car moves."
    return f"With all its sensors, {_said(never, sometimes, 'not told')}."


def _lost(loss: Loss, steady: BoolArray, changing: BoolArray) -> str:
    never = _named(changing & ~loss.told.changing)
    sometimes = _named(steady & ~loss.told.steady & loss.told.changing)
    without = "Without " + listed([SENSOR_WORDS[sensor] for sensor in loss.lost])
    if not never and not sometimes:
        return f"{without}, the others still tell the same, with less certainty."
    return f"{without}, {_said(never, sometimes, 'no longer told')}."


def _said(never: list[str], sometimes: list[str], how: str) -> str:
    parts = []
    if never:
        parts.append(f"{listed(never)} {_be(never)} {how}")
    if sometimes:
        parts.append(f"{listed(sometimes)} {ONLY if never else f'{_be(sometimes)} told {ONLY}'}")
    return "; ".join(parts)


def _be(words: Sequence[str]) -> str:
    return "is" if len(words) == 1 and words[0] not in PLURALS else "are"


def _named(which: BoolArray) -> list[str]:
    if which[BIASES].all():
        return [*_named(which & ~np.isin(np.arange(len(which)), BIASES)), ALL_BIASES]
    return [STATE_WORDS[state] for state in State if which[state]]


def listed(words: Sequence[str]) -> str:
    """Return ``a``, ``a and b`` or ``a, b and c``."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
