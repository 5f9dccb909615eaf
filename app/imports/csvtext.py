"""Text of a CSV file made plain: its encoding, its delimiter, its header, its first data line."""

from __future__ import annotations

import csv
from dataclasses import dataclass

from app.science.errors import SignalsError

_BOMS = ((b"\xef\xbb\xbf", "utf-8"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
DELIMITERS = (",", ";", "\t")


@dataclass(frozen=True, slots=True)
class CsvText:
    """A CSV file as UTF-8 with its header taken apart.

    Attributes
    ----------
    body : bytes
        The lines below the header, UTF-8.
    names : tuple of str
        Column names without surrounding blanks; empty ones are numbered.
    delimiter : str
        Comma, semicolon or tab.
    header_row : int
        Row of the header in the file, 1-based.
    """

    body: bytes
    names: tuple[str, ...]
    delimiter: str
    header_row: int

    @property
    def decimal_comma(self) -> bool:
        """Whether a comma inside a number is a decimal comma: wherever it isn't the delimiter."""
        return self.delimiter != ","


def open_csv(data: bytes) -> CsvText:
    """Find encoding, delimiter and header of a CSV file.

    Empty lines, lines that begin with ``#`` and a spreadsheet's ``sep=;`` are skipped before the header. Text that is
    not UTF-8 is taken for Windows-1252.

    Raises
    ------
    SignalsError
        When there is no header line with at least two columns.
    """
    text = _utf8(data)
    start, row, delimiter = 0, 1, ""
    while start < len(text):
        end = text.find(b"\n", start)
        end = len(text) if end < 0 else end
        line = text[start:end].decode().strip("\r\n\ufeff ")
        if line.lower().startswith("sep=") and len(line) == 5:
            delimiter = line[4]
        elif line and not line.startswith("#"):
            break
        start, row = end + 1, row + 1
    else:
        raise SignalsError("The file is empty; a table with a header line is expected.")
    delimiter = delimiter or max(DELIMITERS, key=line.count)
    try:
        names = [name.strip() for name in next(csv.reader([line], delimiter=delimiter))]
    except csv.Error as error:
        raise SignalsError(f"Row {row}: this can't be the header of a table ({error}).", row) from error
    if len(names) < 2:
        raise SignalsError(
            f"Row {row}: no columns are separated by comma, semicolon or tab; a header such as “t_s,speed_mps” is "
            f"expected.",
            row,
        )
    return CsvText(text[end + 1 :], _unique(names), delimiter, row)


def _utf8(data: bytes) -> bytes:
    for bom, encoding in _BOMS:
        if data.startswith(bom):
            return data[3:] if encoding == "utf-8" else data.decode(encoding, "replace").encode()
    try:
        data.decode()
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace").encode()
    return data


def _unique(names: list[str]) -> tuple[str, ...]:
    """Give every column a name of its own; a repeated name's later columns become ``name#2``, ``name#3``."""
    seen: dict[str, int] = {}
    result = []
    for position, name in enumerate(names, start=1):
        name = name or f"column {position}"
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name}#{seen[name]}")
    return tuple(result)
