"""Keeping estimates: the whole answer among the files, its numbers in a row; or why there is none."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.carrying import kept_carry
from app.batteries.estimating import Question
from app.batteries.keys import estimates_folder
from app.batteries.models import BatteryEstimate
from app.batteries.sources import Source
from app.jobs import service as jobs
from app.jsonable import jsonable
from app.storage.base import new_id, now
from app.storage.outbox import afterwards
from app.storage.resources import Resources
from app.trips import service as trips

if TYPE_CHECKING:
    from app.science.battery.answer import BatteryEstimate as Answer

WITH_SD = (
    "capacity_ah",
    "resistance_ohm",
    "relaxation_capacitance_f",
    "relaxation_resistance_ohm",
    "soc",
    "soh",
    "current_bias_a",
)
NUMBERS = (*(name for value in WITH_SD for name in (value, f"{value}_sd")), "voltage_rms_v", "voltage_noise_v")
"""What of an answer stands in its row, by the answer's own names."""


def keep(resources: Resources, fleet_id: str, asked: Question, found: Answer, *, took_over: bool) -> jobs.Store:
    """Write an answer among the files, and return what writes its row."""
    document = jsonable(found.document())
    assert isinstance(document, dict)  # noqa: S101 - what a mapping becomes
    key = f"{estimates_folder(fleet_id, asked.battery_id, asked.source.id)}/{asked.key}.json"
    resources.blobs.put(key, json.dumps(document, separators=(",", ":"), allow_nan=False).encode())
    carry = kept_carry(found.carry, asked.config)
    provenance = asked.provenance(took_over=took_over)

    def store(session: Session) -> None:
        row = _row(session, asked.battery_id, asked.source)
        if row is None:
            return  # it was removed meanwhile, and the file goes with the next sweep
        _forget_document(session, resources, row, but=key)
        row.began_at, row.ended_at = asked.span.began_at, asked.span.ended_at
        row.key, row.document_key, row.reason, row.made_at = asked.key, key, "", now()
        row.estimator, row.code_version = asked.config.estimator, asked.code
        row.follows_id = None if asked.earlier is None else asked.earlier.id
        row.carry, row.provenance, row.warnings = carry, provenance, list(document["warnings"])
        row.charge_ah = asked.charge_ah()
        _number(row, document)

    return store


def refuse(resources: Resources, battery_id: str, source: Source, reason: str, session: Session) -> None:
    """Write down why a source says nothing; what it said before is forgotten."""
    row = _row(session, battery_id, source)
    if row is None:
        return
    _forget_document(session, resources, row, but="")
    row.key, row.document_key, row.reason, row.made_at = "", None, reason, now()
    row.estimator, row.code_version = "", resources.settings.code_version
    row.carry, row.follows_id, row.provenance, row.warnings, row.charge_ah = None, None, {}, [], None
    _number(row, {})


def forget(resources: Resources, battery_id: str, source: Source, session: Session) -> None:
    """Remove what a source said, which no longer tells of a battery."""
    row = _kept(session, battery_id, source)
    if row is not None:
        _forget_document(session, resources, row, but="")
        session.delete(row)


def _number(row: BatteryEstimate, document: Mapping[str, Any]) -> None:
    for name in NUMBERS:
        setattr(row, name, document.get(name))


def _row(session: Session, battery_id: str, source: Source) -> BatteryEstimate | None:
    """Return the row of a source, locked with its battery; None when battery or source are gone."""
    if repository.battery(session, battery_id, lock=True) is None or not _is_there(session, source):
        return None
    row = _kept(session, battery_id, source)
    if row is None:
        moment = source.zero_at
        row = BatteryEstimate(
            id=new_id(), battery_id=battery_id, trip_id=source.trip_id, file_id=source.file_id, source=source.name
        )
        row.began_at = row.ended_at = moment
        session.add(row)
    return row


def _is_there(session: Session, source: Source) -> bool:
    if source.trip_id is not None:
        return trips.decoded_trip(session, source.trip_id) is not None
    return source.file_id is not None and repository.file(session, source.file_id) is not None


def _kept(session: Session, battery_id: str, source: Source) -> BatteryEstimate | None:
    if source.trip_id is not None:
        return repository.of_trip(session, battery_id, source.trip_id)
    return None if source.file_id is None else repository.of_file(session, source.file_id)


def _forget_document(session: Session, resources: Resources, row: BatteryEstimate, *, but: str) -> None:
    if row.document_key is not None and row.document_key != but:
        afterwards(session, partial(resources.blobs.delete, row.document_key))
