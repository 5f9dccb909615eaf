"""Tunings as people choose them for a trip."""

from __future__ import annotations

from typing import Any

from app.science.observer.tuning import Tuning, tuning_from_dict


def tuning_of(choice: str | dict[str, Any]) -> Tuning:
    """Return the tuning that the name of a preset or an object of entries means; raises `TuningError`."""
    if isinstance(choice, str):
        return tuning_from_dict({"base": choice}, choice)
    return tuning_from_dict(choice, "custom")
