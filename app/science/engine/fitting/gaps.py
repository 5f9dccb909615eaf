"""Where the engine could run but was hardly driven: what to drive for a better map, the thesis' third remedy (3.4)."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.fitting.cells import BLOCK_NM, BLOCK_RPM, RADPS_PER_RPM
from app.science.engine.rules import PointRules

HARDLY = 0.25
MOST_GAPS = 4
FEWEST_BLOCKS = 3


@dataclass(frozen=True, slots=True)
class Gap:
    """A rectangle below full load that was hardly driven.

    Attributes
    ----------
    rpm_range, nm_range : (float, float)
    up_to_full_load, down_to_nothing : bool
        Whether there is only full load above it, and nothing that propels the car below it.
    cells : int
        Cells of the map in it that could be driven.
    """

    rpm_range: tuple[float, float]
    nm_range: tuple[float, float]
    up_to_full_load: bool
    down_to_nothing: bool
    cells: int

    def words(self) -> str:
        """Return the gap as a person says it."""
        (low, high), (bottom, top) = self.rpm_range, self.nm_range
        torque = f"{bottom:.0f}–{top:.0f} Nm"
        if self.up_to_full_load and self.down_to_nothing:
            torque = "at any torque"
        elif self.up_to_full_load:
            torque = f"above {bottom:.0f} Nm"
        elif self.down_to_nothing:
            torque = f"below {top:.0f} Nm"
        return f"{_spaced(low)}–{_spaced(high)} rpm, {torque}: hardly driven"


def _spaced(number: float) -> str:
    return f"{number:,.0f}".replace(",", "\u202f")


def gaps(efficiency_map: EfficiencyMap) -> tuple[Gap, ...]:
    """Return the largest rectangles below full load, in blocks of 250 rpm by 10 Nm, that were hardly driven.

    None when full load isn't known: then nothing tells what the engine could do. Of coarser cells, a block has as many
    as it takes.
    """
    line_rpm, line_nm = efficiency_map.full_load_rpm, efficiency_map.full_load_nm
    if len(line_rpm) < 2:
        return ()
    grid = efficiency_map.grid
    rpm = grid.centre_rpm(np.arange(int(grid.column(line_rpm.min())), int(grid.column(line_rpm.max())) + 1))
    nm = grid.centre_nm(np.arange(int(grid.row(line_nm.max())) + 1))
    ceiling = np.interp(rpm, line_rpm, line_nm)
    possible = (nm[None, :] <= ceiling[:, None]) & (
        rpm[:, None] * RADPS_PER_RPM * nm[None, :] > PointRules().min_power_w
    )
    driven = _trusted_on(efficiency_map, int(grid.column(rpm)[0]), possible.shape) & possible
    wide, tall = ceil(BLOCK_RPM / grid.rpm) * grid.rpm, ceil(BLOCK_NM / grid.nm) * grid.nm
    column, row = (rpm // wide).astype(np.int64), (nm // tall).astype(np.int64)
    first = int(column[0])
    can, did = (_by_block(mask, column - first, row) for mask in (possible, driven))
    whole = (grid.rpm * grid.nm) / (wide * tall)
    left = (can * whole > HARDLY) & (did < HARDLY * can)
    found: list[Gap] = []
    while len(found) < MOST_GAPS and left.any():
        across, up = _largest_rectangle(left, can)
        box = (slice(*across), slice(*up))
        if left[box].size < FEWEST_BLOCKS:
            break
        found.append(
            Gap(
                rpm_range=((first + across[0]) * wide, (first + across[1]) * wide),
                nm_range=(up[0] * tall, up[1] * tall),
                up_to_full_load=not (can[slice(*across), up[1] :] * whole > HARDLY).any(),
                down_to_nothing=not (can[slice(*across), : up[0]] * whole > HARDLY).any(),
                cells=int(can[box].sum()),
            )
        )
        left[box] = False
    return tuple(sorted(found, key=lambda gap: -gap.cells))


def _trusted_on(efficiency_map: EfficiencyMap, first_column: int, shape: tuple[int, ...]) -> BoolArray:
    """Return the trusted cells on a rectangle of the grid that begins at a column, and at torque 0."""
    known, grid = np.isfinite(efficiency_map.efficiency), efficiency_map.grid
    column, row = grid.column(efficiency_map.rpm[known]) - first_column, grid.row(efficiency_map.nm[known])
    inside = (column >= 0) & (column < shape[0]) & (row >= 0) & (row < shape[1])
    found = np.zeros(shape, np.bool_)
    found[column[inside], row[inside]] = True
    return found


def _by_block(mask: BoolArray, column: IntArray, row: IntArray) -> IntArray:
    """Return how many cells of each block a mask holds, shape (blocks across, blocks up)."""
    width, height = int(column[-1]) + 1, int(row[-1]) + 1
    block = column[:, None] * height + row[None, :]
    return np.bincount(block.ravel(), mask.ravel(), width * height).reshape(width, height).astype(np.int64)


def _largest_rectangle(mask: BoolArray, worth: IntArray) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the (first, past the last) column and row of the rectangle inside a mask that is worth most."""
    missing, value = (_summed(part) for part in (~mask, worth))
    best, found = -1.0, ((0, 1), (0, 1))
    width, height = mask.shape
    for low in range(width):
        for high in range(low + 1, width + 1):
            outside = missing[high] - missing[low]
            if not (np.diff(outside) == 0.0).any():
                break  # no row of blocks is free from here on, whatever is added
            inside = value[high] - value[low]
            tops = np.searchsorted(outside, outside, side="right") - 1
            gain = np.where(tops > np.arange(height + 1), inside[tops] - inside, -1.0)
            bottom = int(np.argmax(gain))
            if gain[bottom] > best:
                best, found = float(gain[bottom]), ((low, high), (bottom, int(tops[bottom])))
    return found


def _summed(values: BoolArray | IntArray) -> FloatArray:
    """Return sums over everything below and to the left, with a leading row and column of zeros."""
    sums = np.zeros((values.shape[0] + 1, values.shape[1] + 1))
    sums[1:, 1:] = values.astype(np.float64).cumsum(axis=0).cumsum(axis=1)
    return sums
