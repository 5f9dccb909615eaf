"""The benchmark of the formulas measures what it says."""

from __future__ import annotations

import numpy as np
import pytest

from app.cli.bench.fitting import engine, measure, plainly
from app.science.engine.fitting.cells import TARGETS, trusted_cells
from app.science.engine.fitting.polynomial import FEWEST_CELLS, fit
from app.science.engine.fitting.terms import classes


def test_the_reference_does_the_same_in_the_plain_way() -> None:
    cells = trusted_cells(engine(), fewest=FEWEST_CELLS)
    for target in TARGETS:
        for terms in classes(2):
            ours = fit(cells, target, terms).cross_validated
            assert plainly(cells, target, terms) == pytest.approx(ours, rel=1e-6)


def test_the_page_gets_less_than_promised() -> None:
    time, size = measure()
    assert (time.unit, size.unit) == ("ms", "kB")
    assert np.isfinite(time.ratio)
    assert size.value < 300.0
