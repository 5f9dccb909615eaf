"""Tables as they come: what a column holds, and what is said of one that holds no numbers."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from app.imports.table import read_table


@pytest.mark.parametrize("values", [pa.array([[1.0], [2.0]]), pa.array([{"a": 1}, {"a": 2}])], ids=["lists", "structs"])
def test_a_column_of_no_numbers_counts_as_empty_and_is_named(values: pa.Array) -> None:
    buffer = BytesIO()
    pq.write_table(pa.table({"t_s": [0.0, 1.0], "odd": values}), buffer)
    table = read_table(buffer.getvalue())
    assert np.isnan(table.numbers("odd")).all()
    assert [warning for warning in table.warnings if warning.startswith("odd: ") and "not numbers" in warning]
    np.testing.assert_array_equal(table.numbers("t_s"), [0.0, 1.0])
