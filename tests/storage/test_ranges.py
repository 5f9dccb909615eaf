"""Objects of an object store are read like files, a range at a time."""

from __future__ import annotations

import io

import numpy as np
import obstore
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from obstore.store import MemoryStore

from app.storage.ranges import ObjectReader


def test_reads_and_seeks_like_a_file_of_the_same_bytes() -> None:
    data = np.random.default_rng(5).bytes(100_000)
    store = MemoryStore()
    obstore.put(store, "x", data)
    ours, theirs = io.BufferedReader(ObjectReader(store, "x"), 1000), io.BytesIO(data)
    for offset, whence, count in ((0, 0, 10), (5000, 0, 3000), (-7, 2, 100), (-50, 1, 20), (200_000, 0, 5), (0, 0, -1)):
        assert ours.seek(offset, whence) == theirs.seek(offset, whence)
        assert ours.read(count) == theirs.read(count)


def test_serves_parquet() -> None:
    table = pa.table({"a": np.arange(10_000), "b": np.ones(10_000)})
    buffer = io.BytesIO()
    pq.write_table(table, buffer, row_group_size=1000)
    store = MemoryStore()
    obstore.put(store, "x", buffer.getvalue())
    assert pq.ParquetFile(io.BufferedReader(ObjectReader(store, "x"))).read(columns=["a"])["a"].equals(table["a"])


def test_a_missing_object_is_a_missing_file() -> None:
    with pytest.raises(FileNotFoundError):
        ObjectReader(MemoryStore(), "nothing")
