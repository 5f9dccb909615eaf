"""How a car's map grows: what a trip adds is summed once, and the map is read from the sums of all."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from app.maps.packing import pack_sums, unpack_moments, unpack_sums
from app.maps.sides import GRID
from app.science.engine.cells import accumulate, build_map, merge
from app.science.engine.efficiency_map import CellSums, EfficiencyMap
from app.science.engine.full_load import full_load_curve
from app.science.engine.idle import IdleSums, idle_of
from app.science.engine.moments import merge_moments, moments_of
from app.science.engine.points import OperatingPoints
from app.science.engine.resolution import resolve
from app.science.vehicle.model import Vehicle


@dataclass(frozen=True, slots=True)
class Grown:
    """A map, and the cells of each trip in it."""

    map: EfficiencyMap
    cells: Mapping[str, CellSums]


def added_by(points: OperatingPoints) -> bytes:
    """Return what a trip's operating points add to a map."""
    return pack_sums(accumulate(points, GRID), moments_of(points))


def grown(packed: Mapping[str, bytes], idles: Iterable[IdleSums], vehicle: Vehicle) -> Grown:
    """Return the map of trips.

    Parameters
    ----------
    packed : mapping of str to bytes
        What each trip adds, as `added_by` returned it. Trips are added up in this order.
    idles : iterable of IdleSums
    vehicle : Vehicle
    """
    cells = {trip: unpack_sums(data) for trip, data in packed.items()}
    resolved = resolve(merge(cells.values()), GRID)
    full_load = full_load_curve(merge_moments(unpack_moments(data) for data in packed.values()))
    return Grown(build_map(resolved.sums, resolved.grid, vehicle, full_load, idle_of(idles, vehicle)), cells)
