"""Reading the states of a trip: only the columns that are asked for, so that a few of many come in milliseconds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import TracebackType
from typing import Any

import numpy as np
import pyarrow.parquet as pq

from app.errors import Invalid, PonthyError
from app.science.arrays import FloatArray
from app.storage.blobs import Blobs
from app.trips.keys import STATES, result_file
from app.trips.models import Trip

TIME = "t_s"


class StatesTable:
    """The states table of a trip, open for reading; a context manager.

    Raises
    ------
    PonthyError
        When the trip has no result yet.
    """

    def __init__(self, blobs: Blobs, trip: Trip) -> None:
        self._file = blobs.open(result_file(trip, observe_key(trip), STATES))
        self._table = pq.ParquetFile(self._file)

    def __enter__(self) -> StatesTable:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._table.close()
        self._file.close()

    @property
    def names(self) -> list[str]:
        """All columns."""
        return list(self._table.schema_arrow.names)

    def check(self, names: Iterable[str]) -> None:
        """Raise `Invalid` when a name is not that of a quantity in the table."""
        unknown = sorted(set(names) - set(self.names) | {TIME} & set(names))
        if unknown:
            known = ", ".join(name for name in self.names if name != TIME and not name.endswith("_sd"))
            message = f"There is no signal {unknown[0]!r} in this trip; there are {known}."
            raise Invalid("unknown-signal", message, field="signals")

    def with_deviations(self, names: Sequence[str]) -> list[str]:
        """Return quantities followed by those of their standard deviations that are in the table."""
        present = set(self.names)
        return list(dict.fromkeys([*names, *(f"{name}_sd" for name in names if f"{name}_sd" in present)]))

    def columns(
        self, names: Sequence[str], from_s: float | None = None, to_s: float | None = None
    ) -> dict[str, FloatArray]:
        """Return the time and columns, from the node before a span of time to the one after it; NaN where unknown."""
        read = self._table.read(columns=[TIME, *(name for name in names if name != TIME)])
        columns = {name: _numbers(read[name]) for name in read.column_names}
        t = columns[TIME]
        first = 0 if from_s is None else max(int(np.searchsorted(t, from_s, "left")) - 1, 0)
        last = len(t) if to_s is None else int(np.searchsorted(t, to_s, "right")) + 1
        return {name: values[first:last] for name, values in columns.items()}


def observe_key(trip: Trip) -> str:
    """Return the name of the observer run that is shown; raises `PonthyError` when there is none yet."""
    if trip.observe_key is None:
        raise PonthyError("not-observed", "This trip has no result yet; its job tells how far it is.", 409)
    return trip.observe_key


def _numbers(column: Any) -> FloatArray:
    return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)
