"""What was estimated of batteries: whole answers, histories, files to save."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from sqlalchemy.orm import Session

from app.answers import FileFormat
from app.batteries import repository
from app.batteries.models import Battery, BatteryEstimate
from app.batteries.schemas import EstimateView
from app.errors import Conflict
from app.exports.battery import answer_csv, answer_parquet, history_csv, history_parquet
from app.storage.blobs import Blobs

FormatName = Literal["csv", "json", "parquet"]

FORMATS: Mapping[FormatName, FileFormat] = {
    "csv": FileFormat(".csv", "text/csv; charset=utf-8"),
    "json": FileFormat(".json", "application/json"),
    "parquet": FileFormat(".parquet", "application/vnd.apache.parquet"),
}
NOTHING_YET = "Nothing has been estimated of this battery yet. Send a file with its current and voltage, or drive."


def answer_of(blobs: Blobs, estimate: BatteryEstimate) -> dict[str, Any]:
    """Return a whole answer as `./ponthy battery --json` gives it, with where it came from.

    Raises
    ------
    Conflict
        When the trip or file says nothing; the message tells why.
    """
    if estimate.document_key is None:
        raise Conflict("no-estimate", estimate.reason)
    document: dict[str, Any] = json.loads(blobs.get(estimate.document_key))
    row = EstimateView.model_validate(estimate).model_dump(mode="json")
    about = {name: row[name] for name in ("id", "battery_id", "trip_id", "file_id", "source", "began_at", "ended_at")}
    return document | about | {"provenance": estimate.provenance}


def latest(session: Session, battery: Battery) -> BatteryEstimate | None:
    """Return the latest estimate that came to something."""
    return next(iter(repository.newest(session, [battery.id])), None)


def export_answer(answer: dict[str, Any], form: FormatName) -> bytes:
    """Return a whole answer as a file: json has everything, the tables what it says over time."""
    match form:
        case "json":
            return _text(answer)
        case "csv":
            return answer_csv(answer)
        case "parquet":
            return answer_parquet(answer)


def export_history(session: Session, battery: Battery, form: FormatName) -> bytes:
    """Return a battery's history as a file, in the order of time; raises `Conflict` while there is none."""
    estimates = repository.history(session, battery.id)
    if not estimates:
        raise Conflict("no-history", NOTHING_YET)
    rows = [_row(estimate) for estimate in estimates]
    about = {"battery_id": battery.id, "car_id": battery.car_id, "name": battery.name}
    match form:
        case "json":
            return _text(about | {"estimates": rows})
        case "csv":
            return history_csv(_flat(rows))
        case "parquet":
            return history_parquet(_flat(rows), about)


def _row(estimate: BatteryEstimate) -> dict[str, Any]:
    row = EstimateView.model_validate(estimate).model_dump(mode="json", exclude={"reason", "battery_id"})
    return row | {"config_revision": estimate.provenance["config_revision"], "code_version": estimate.code_version}


def _flat(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    return [{**row, "warnings": " ".join(row["warnings"])} for row in rows]


def _text(document: Mapping[str, Any]) -> bytes:
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False).encode()
