"""A table of any supported form (CSV, packed CSV, Parquet) as columns of numbers and texts with their row numbers."""

from __future__ import annotations

import json
import re
import zlib
from base64 import b64decode
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv
import pyarrow.parquet as pq

from app.imports.csvtext import CsvText, open_csv
from app.imports.gzipped import MAGIC, unpack
from app.science.arrays import FloatArray, IntArray
from app.science.errors import SignalsError

LARGEST_BYTES = 256_000_000
MOST_CELLS = 60_000_000
METADATA_KEY = b"ponthy"
_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$"
_NOTHING = ["", "nan", "NaN", "NAN", "null", "NULL", "None", "NA", "N/A", "n/a", "-", "#N/A"]


@dataclass(slots=True)
class Table:
    """Columns of one file.

    Attributes
    ----------
    names : tuple of str
        Column names in order.
    row : array of int, shape (rows,)
        Row of the file each entry stands in; the header of a CSV file is row 1.
    warnings : list of str
        What was left out or repaired; reading a column adds to it.
    metadata : mapping
        What Ponthy wrote into its own Parquet file; empty for any other.
    """

    names: tuple[str, ...]
    row: IntArray
    warnings: list[str]
    metadata: Mapping[str, Any]
    _columns: Mapping[str, Any] = field(repr=False)
    _decimal_comma: bool = False
    _first_bad: dict[str, int] = field(default_factory=dict, repr=False)
    _numbers: dict[str, FloatArray] = field(default_factory=dict, repr=False)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def numbers(self, name: str) -> FloatArray:
        """Return a column as numbers, NaN where a cell is empty or not a number (which is said in `warnings`)."""
        if name not in self._numbers:
            column = self._columns[name]
            self._numbers[name] = self._parsed(name, column) if _is_text(column) else self._taken(name, column)
        return self._numbers[name]

    def times(self, name: str) -> FloatArray:
        """Return a column of times: numbers, or dates as seconds since 1970-01-01 UTC."""
        column = self._columns[name]
        if pa.types.is_temporal(column.type):
            return _as_epoch(column)
        stamps = _parse_dates(column) if _is_text(column) and not _begins_as_number(column) else None
        return self.numbers(name) if stamps is None else stamps

    def texts(self, name: str) -> tuple[IntArray, list[str]]:
        """Return a column of few different texts: an index for each row (−1: none) and the texts."""
        column = pc.utf8_trim_whitespace(pc.cast(self._columns[name], pa.string()))
        coded = pc.dictionary_encode(column).combine_chunks()
        coded = coded.chunk(0) if isinstance(coded, pa.ChunkedArray) else coded
        index = np.asarray(pc.fill_null(coded.indices, -1), dtype=np.int64)
        return index, [str(text) for text in coded.dictionary.to_pylist()]

    def first_bad_row(self, name: str) -> int:
        """Return the row of the first cell of a column that isn't a number; 0 when all are."""
        return self._first_bad.get(name, 0)

    def _taken(self, name: str, column: Any) -> FloatArray:
        try:
            return _as_float(column)
        except (pa.ArrowInvalid, pa.ArrowNotImplementedError):
            # Whether such a column holds numbers shows only when it is cast: bytes may. If not, this one column is
            # lost, which the warning tells the user; the others count on.
            self.warnings.append(f"{name}: it holds values of type {column.type}, not numbers, and counts as empty.")
            return np.full(len(column), np.nan)

    def _parsed(self, name: str, column: Any) -> FloatArray:
        text = pc.utf8_trim_whitespace(column)
        if self._decimal_comma:
            text = pc.replace_substring(text, ",", ".")
        text = pc.if_else(pc.is_in(text, pa.array(_NOTHING)), pa.scalar(None, pa.string()), text)
        try:
            return _as_float(pc.cast(text, pa.float64()))
        except pa.ArrowInvalid:
            number = pc.fill_null(pc.match_substring_regex(text, _NUMBER), False)
        bad = np.flatnonzero(np.asarray(pc.and_(pc.invert(number), pc.is_valid(text))))
        if len(bad):
            row = int(self.row[bad[0]])
            self._first_bad[name] = row
            cells = (
                "1 cell that isn't a number counts" if len(bad) == 1 else f"{len(bad)} cells that aren't numbers count"
            )
            shown = str(text[int(bad[0])].as_py())[:40]
            self.warnings.append(f"{name}: {cells} as empty (first in row {row}: “{shown}”).")
        return _as_float(pc.cast(pc.if_else(number, text, pa.scalar(None, pa.string())), pa.float64()))


def read_table(data: bytes) -> Table:
    """Read a CSV file (comma, semicolon or tab; may be packed with gzip) or a Parquet file.

    Raises
    ------
    SignalsError
        When the file is no table, is too large, or holds no row.
    """
    warnings: list[str] = []
    if data.startswith(MAGIC):
        unpacked = unpack(data, LARGEST_BYTES)
        data = unpacked.content
        if unpacked.torn:
            warnings.append("The packed file breaks off or is damaged; the rows before that are used.")
            data = data[: data.rfind(b"\n") + 1]
    if len(data) > LARGEST_BYTES:
        raise SignalsError(f"The file has more than {LARGEST_BYTES // 1_000_000} MB. Split it by trip.")
    if data.startswith(b"PAR1"):
        return _read_parquet(data, warnings)
    return _read_csv(open_csv(data), warnings)


def _read_csv(text: CsvText, warnings: list[str]) -> Table:
    skipped: list[int] = []
    wrong: list[int] = []

    def skip(row: Any) -> str:
        skipped.append(int(row.number))
        if str(row.text).strip():
            wrong.append(int(row.number))
        return "skip"

    try:
        arrow = pyarrow.csv.read_csv(
            pa.BufferReader(text.body),
            pyarrow.csv.ReadOptions(use_threads=False, column_names=text.names, block_size=1 << 24),
            pyarrow.csv.ParseOptions(delimiter=text.delimiter, ignore_empty_lines=False, invalid_row_handler=skip),
            pyarrow.csv.ConvertOptions(column_types=dict.fromkeys(text.names, pa.string()), strings_can_be_null=False),
        )
    except (pa.ArrowInvalid, pa.ArrowKeyError) as error:
        reason = "there is no row below the header" if "Empty CSV" in str(error) else str(error).partition("\n")[0]
        raise SignalsError(f"The file can't be read as a table: {reason}.", text.header_row) from error
    if wrong:
        rows = "1 row has" if len(wrong) == 1 else f"{len(wrong)} rows have"
        warnings.append(
            f"{rows} another number of columns than the header and were left out (first: row "
            f"{wrong[0] + text.header_row})."
        )
    number = np.delete(np.arange(1, arrow.num_rows + len(skipped) + 1), np.array(skipped, np.int64) - 1)
    if pc.any(pc.equal(arrow.column(0), "")).as_py():  # perhaps an empty line, which says nothing
        filled = pc.invert(reduce(pc.and_, (pc.equal(column, "") for column in arrow.columns)))
        arrow, number = arrow.filter(filled), number[np.asarray(filled, dtype=np.bool_)]
    return _checked(arrow, number + text.header_row, warnings, {}, text.decimal_comma)


def _read_parquet(data: bytes, warnings: list[str]) -> Table:
    try:
        file = pq.ParquetFile(pa.BufferReader(data))
        rows, columns = file.metadata.num_rows, file.metadata.num_columns
        unpacked = sum(file.metadata.row_group(i).total_byte_size for i in range(file.metadata.num_row_groups))
        if rows * columns > MOST_CELLS or unpacked > LARGEST_BYTES * 4:
            raise SignalsError(f"The file holds {rows} rows of {columns} columns. Split it by trip.")
        arrow = file.read()
        arrow.validate(full=True)
    except SignalsError:
        raise
    except (pa.ArrowException, OSError, ValueError, OverflowError, MemoryError) as error:  # damage shows in many ways
        raise SignalsError(
            "The Parquet file is damaged or breaks off; copy or export it again. "
            f"(It says: {str(error).partition(chr(10))[0][:120]})"
        ) from error
    metadata = _metadata((file.schema_arrow.metadata or {}).get(METADATA_KEY))
    return _checked(arrow, np.arange(1, arrow.num_rows + 1) + 1, warnings, metadata, decimal_comma=False)


def _metadata(packed: bytes | None) -> Mapping[str, Any]:
    """Unpack what `app.exports.parquet.recording_parquet` packed; nothing when it is damaged."""
    if packed is None:
        return {}
    try:
        found = json.loads(zlib.decompressobj().decompress(b64decode(packed), LARGEST_BYTES))
    except (ValueError, zlib.error):
        return {}
    return found if isinstance(found, dict) else {}


def _checked(arrow: Any, row: IntArray, warnings: list[str], metadata: Mapping[str, Any], decimal_comma: bool) -> Table:
    if arrow.num_rows * arrow.num_columns > MOST_CELLS:
        raise SignalsError(f"The file holds {arrow.num_rows} rows of {arrow.num_columns} columns. Split it by trip.")
    if not arrow.num_rows:
        raise SignalsError("The table has a header and no row that can be read.", 2)
    names = tuple(str(name).strip() for name in arrow.column_names)
    columns = {name: _flat(column) for name, column in zip(names, arrow.columns, strict=True)}
    return Table(names, row, warnings, metadata, columns, decimal_comma)


def _flat(column: Any) -> Any:
    if pa.types.is_dictionary(column.type):
        column = pc.cast(column, column.type.value_type)
    return pc.cast(column, pa.string()) if pa.types.is_large_string(column.type) else column


def _is_text(column: Any) -> bool:
    return bool(pa.types.is_string(column.type))


def _as_float(column: Any) -> FloatArray:
    """Return an Arrow column as floats; infinities and missing values become NaN."""
    values = np.array(pc.cast(column, pa.float64(), safe=False).to_numpy(), dtype=np.float64)
    values[~np.isfinite(values)] = np.nan
    return values


def _as_epoch(column: Any) -> FloatArray:
    stamps = pc.cast(column, pa.timestamp("us", tz="UTC") if getattr(column.type, "tz", None) else pa.timestamp("us"))
    return _as_float(pc.cast(stamps, pa.int64())) / 1e6


def _begins_as_number(column: Any) -> bool:
    first = next((str(text).strip() for text in column.slice(0, 100).to_pylist() if str(text or "").strip()), "")
    return re.fullmatch(_NUMBER, first.replace(",", ".")) is not None


def _parse_dates(column: Any) -> FloatArray | None:
    """Return ISO dates as seconds since 1970 (UTC where no zone is written), or None when they are something else."""
    text = pc.utf8_trim_whitespace(column)
    text = pc.if_else(pc.equal(text, ""), pa.scalar(None, pa.string()), text)
    for kind in (pa.timestamp("us"), pa.timestamp("us", tz="UTC")):
        try:
            return _as_float(pc.cast(pc.cast(text, kind), pa.int64())) / 1e6
        except pa.ArrowInvalid:
            continue
    return None
