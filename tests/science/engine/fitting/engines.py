"""An engine whose formula is known, for tests of the fits."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from app.science.arrays import BoolArray, IntArray
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap, Idle
from app.science.engine.fitting import cells
from app.science.engine.fitting.polynomial import FEWEST_CELLS
from app.science.engine.fitting.terms import classes

PHI = np.array([9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04])
TABLE_4_1 = next(one for one in classes(2) if one.name == "table 4.1")
IDLE = Idle(850.0, 15.0, 7000.0, 60.0, 0.79, 400.0)
COLUMNS = ("rpm", "nm", "n", "efficiency", "sd", "bsfc_gpkwh")

trusted_cells = partial(cells.trusted_cells, fewest=FEWEST_CELLS)


def engine(noise: float = 0.0, seed: int = 1) -> EfficiencyMap:
    """The thesis' engine (Table 4.1) over most of its area, with noisy cells."""
    rng = np.random.default_rng(seed)
    rpm, nm = (a.ravel() for a in np.meshgrid(np.arange(1025.0, 5500.0, 50.0), np.arange(11.0, 100.0, 2.0)))
    inside = nm < 40.0 + 0.03 * (rpm - 1000.0)
    rpm, nm = rpm[inside], nm[inside]
    omega = rpm * np.pi / 30.0
    efficiency = 1.0 / (TABLE_4_1.columns(omega, nm) @ PHI) + noise * rng.standard_normal(len(rpm))
    line = np.unique(rpm)
    nothing = np.full(len(rpm), 0.01)
    full_load = np.minimum(40.0 + 0.03 * (line - 1000.0), 100.0)
    n = np.full(len(rpm), 40)
    return EfficiencyMap(CellGrid(), rpm, nm, n, efficiency, nothing, 84.0 / efficiency, line, full_load)


def part_of(whole: EfficiencyMap, keep: BoolArray | IntArray) -> EfficiencyMap:
    """Return a map with only some of the cells."""
    return replace(whole, **{name: getattr(whole, name)[keep] for name in COLUMNS})


CELLS = trusted_cells(engine())
