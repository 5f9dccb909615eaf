"""Which speeds a grid looks at: all that can be reached at first, then those near the drives found before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray

MOST_NODES = 130
SAME_MPS = 1e-9


@dataclass(frozen=True, slots=True)
class Corridor:
    """Lowest and highest speeds along a road, and drives whose speeds are nodes, too.

    Attributes
    ----------
    edges_m, low_mps, high_mps : array, shape (n + 1,)
    ways : tuple of array, shape (n + 1,)
    """

    edges_m: FloatArray
    low_mps: FloatArray
    high_mps: FloatArray
    ways: tuple[FloatArray, ...] = ()

    def at(self, edges_m: FloatArray) -> Corridor:
        """Return the corridor at other edges, its kinetic energies linear in between."""
        return Corridor(
            edges_m,
            between_edges(edges_m, self.edges_m, self.low_mps),
            between_edges(edges_m, self.edges_m, self.high_mps),
            tuple(between_edges(edges_m, self.edges_m, way) for way in self.ways),
        )

    def around(self, ways: tuple[FloatArray, ...], reach_mps: float) -> Corridor:
        """Return what of the corridor is near some drives on its edges."""
        low = np.maximum(np.min(ways, axis=0) - reach_mps, self.low_mps)
        high = np.minimum(np.max(ways, axis=0) + reach_mps, self.high_mps)
        return Corridor(self.edges_m, low, high, ways)

    def nodes(self, step_mps: float) -> list[FloatArray]:
        """Return the speeds to look at for each edge: multiples of a step, both bounds and the drives' own."""
        found = []
        for k, (low, high) in enumerate(zip(self.low_mps, self.high_mps, strict=True)):
            step = max(step_mps, (high - low) / MOST_NODES)
            even = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1.0)
            own = np.array([low, high, *(way[k] for way in self.ways)])
            own = np.clip(own, low, high)
            own.sort()
            own = own[np.append(True, np.diff(own) > SAME_MPS)]
            apart = np.abs(even[:, None] - own[None, :]).min(axis=1) > 1e-3 * step + SAME_MPS
            found.append(np.sort(np.concatenate((own, even[apart]))))
        return found

    def touched(self, bounds: Corridor, way: FloatArray, step_mps: float) -> bool:
        """Tell whether a drive runs along the corridor's rim where the road itself leaves room."""
        low = (way <= self.low_mps + 0.5 * step_mps) & (self.low_mps > bounds.low_mps + step_mps)
        high = (way >= self.high_mps - 0.5 * step_mps) & (self.high_mps < bounds.high_mps - step_mps)
        return bool((low | high).any())


def between_edges(edges_m: FloatArray, at_m: FloatArray, speed_mps: FloatArray) -> FloatArray:
    """Return speeds at other edges, with a steady acceleration in between."""
    return np.sqrt(np.interp(edges_m, at_m, speed_mps**2))
