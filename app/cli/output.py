"""What commands say: results on standard output, progress on standard error."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from app.jsonable import jsonable


def note(text: str) -> None:
    """Write one line of progress to standard error."""
    print(text, file=sys.stderr, flush=True)


def json_text(value: object) -> str:
    """Return the value as indented JSON without NaN."""
    return json.dumps(jsonable(value), indent=2, ensure_ascii=False, allow_nan=False)


def say(value: Mapping[str, object], as_json: bool, text: str) -> None:
    """Print a result: the value as JSON for machines, else the text for people."""
    print(json_text(value) if as_json else text)


def write_json(path: Path, value: object) -> None:
    """Write the value to a JSON file."""
    path.write_text(json_text(value) + "\n", encoding="utf-8")


def table(rows: list[list[str]]) -> str:
    """Return rows of words as aligned columns: the first to the left, numbers in the others to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
