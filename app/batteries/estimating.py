"""The estimate of one trip or one file: everything that it depends on, and what the science makes of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.carrying import carried
from app.batteries.configuring import config_key, in_force
from app.batteries.models import Battery, BatteryEstimate
from app.batteries.sources import Source, Span
from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.progress import Progress
from app.storage.keys import stage_key

if TYPE_CHECKING:
    from app.science.battery.answer import BatteryEstimate as Answer

LONGEST_STEP_S = 60.0
"""Over longer steps nobody knows what flowed; they don't count into what went through a battery."""
SECONDS_PER_HOUR = 3600.0


@dataclass(frozen=True, slots=True)
class Question:
    """Everything that an estimate depends on; ``key`` names it, and another question has another key.

    ``earlier`` is what it follows in time, whether or not anything can be taken over from it.
    """

    battery_id: str
    source: Source
    record: BatteryRecord
    span: Span
    config: BatteryConfig
    revision: int
    earlier: BatteryEstimate | None
    key: str
    code: str

    def charge_ah(self) -> float:
        """Return what went through one cell, in and out."""
        steps = np.diff(self.record.t_s)
        moved = np.abs(self.record.current_a[:-1]) * np.where(steps <= LONGEST_STEP_S, steps, 0.0)
        return float(moved.sum()) / SECONDS_PER_HOUR / self.config.cell.parallel

    def provenance(self, *, took_over: bool) -> dict[str, Any]:
        """Return what the estimate is made from."""
        return {
            "measurements": self.source.key,
            "config_key": config_key(self.config),
            "config_revision": self.revision,
            "estimator": self.config.estimator,
            "follows_id": None if self.earlier is None else self.earlier.id,
            "follows_key": None if self.earlier is None else self.earlier.key,
            "time_known": self.span.is_known,
            "carried_over": took_over,
            "code_version": self.code,
        }


def question(session: Session, battery: Battery, source: Source, record: BatteryRecord, code: str) -> Question:
    """Return what there is to estimate.

    Raises
    ------
    Conflict, ProblemError
        When the car's file has no battery, or lacks something that an estimate needs.
    """
    found = in_force(session, battery.car_id)
    config = found.config()
    span = source.span(record)
    earlier = repository.before(session, battery.id, span.began_at, source.id)
    key = stage_key(
        "battery",
        source=source.key,
        began_at=span.began_at.isoformat(),
        time_known=span.is_known,
        config=config_key(config),
        follows=None if earlier is None else earlier.key,
        code=code,
    )
    return Question(battery.id, source, record, span, config, found.revision, earlier, key, code)


def answer(asked: Question, progress: Progress) -> tuple[Answer, bool]:
    """Return the estimate, and whether anything was taken over; raises `ScienceError` when the data won't do."""
    from app.science.battery.estimate import estimate  # for workers only, which have room for its kernels

    carry = carried(asked.earlier, asked.span, asked.config)
    return estimate(asked.record, asked.config, carry, progress), carry is not None
