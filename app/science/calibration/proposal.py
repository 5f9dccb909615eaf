"""What driving says about a car's file: proposed changes with their evidence, never made by themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

Name = Literal[
    "mounting",
    "accelerometer_scale",
    "vss_m_per_tick",
    "injector_lag",
    "injector_flow",
    "accelerometer_bias",
    "gps_latency",
    "clock_skew",
    "road_load",
]
Confidence = Literal["sure", "likely", "weak"]

NAMES: tuple[Name, ...] = get_args(Name)
"""Everything that is looked for, in the order it is told."""


@dataclass(frozen=True, slots=True)
class Change:
    """One number of the car's file, or one that the file has no place for.

    Attributes
    ----------
    field : str
        `app.science.vehicle.field.Field.path` of the value, as `apply_form` takes it; empty for information only.
    label, unit : str
        For people; a field's are those of the form.
    before : float or None
        What the file says, or stands for while it is silent, in the unit; None where there is nothing to compare with.
    after, sd : float
        What driving says and its standard deviation, in the unit.
    """

    field: str
    label: str
    unit: str
    before: float | None
    after: float
    sd: float


@dataclass(frozen=True, slots=True)
class Proposal:
    """Changes that belong together and are taken or left together.

    Attributes
    ----------
    name : str
        One of `NAMES`.
    changes : tuple of Change
    evidence : tuple of str
        What it rests on, in sentences with numbers.
    confidence : {"sure", "likely", "weak"}
        ``weak`` is never a change worth applying: it tells what is known and what is missing.
    trips : int
        How many trips it rests on.
    """

    name: Name
    changes: tuple[Change, ...]
    evidence: tuple[str, ...]
    confidence: Confidence
    trips: int

    @property
    def is_applicable(self) -> bool:
        """Whether it changes the car's file: it has fields of it, and its evidence is not weak."""
        return self.confidence != "weak" and any(change.field for change in self.changes)

    def form_values(self) -> dict[str, float]:
        """Return the new values by field, as `app.science.vehicle.fields.apply_form` takes them."""
        return {change.field: change.after for change in self.changes if change.field} if self.is_applicable else {}
