"""The idling engine as a map's document tells of it."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from app.science.engine.fitting.cells import IdlePoint

UNSAID_SHARE = 0.05
"""Relative deviation assumed of an idle fuel power that comes without one."""


def idle_of(document: Mapping[str, Any]) -> IdlePoint | None:
    """Return the ``idle`` of a ``map.json``, or None when it has none or it isn't of a running engine."""
    idle = document.get("idle") if isinstance(document, Mapping) else None
    if not isinstance(idle, Mapping):
        return None
    rpm, power = _number(idle.get("rpm")), _number(idle.get("fuel_power_w"))
    if rpm is None or power is None or rpm <= 0.0 or power <= 0.0:
        return None
    sd = _number(idle.get("fuel_power_sd_w"))
    return IdlePoint(rpm, power, UNSAID_SHARE * power if sd is None or sd <= 0.0 else sd)


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) and isfinite(value) else None
