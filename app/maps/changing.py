"""What is different from a map to the next one of the same car."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from app.maps.models import MapVersion
from app.maps.sides import GRID
from app.science.engine.compare import MapDifference, compare_maps
from app.science.engine.compare_trips import compare_trips
from app.science.engine.efficiency_map import CellSums, EfficiencyMap
from app.science.errors import ScienceError

SAME_CIRCUMSTANCES = ("rules", "config_sha256")


def trips_changed(before: MapVersion, provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Tell which trips came, went or were observed anew since a version, and what else about it is different."""
    old = {trip["trip_id"]: trip for trip in before.provenance["trips"]}
    new = {trip["trip_id"]: trip for trip in provenance["trips"]}

    def named(trips: Mapping[str, Any], chosen: set[str]) -> list[dict[str, str]]:
        return [{"trip_id": trip_id, "name": trip["name"]} for trip_id, trip in trips.items() if trip_id in chosen]

    anew = {trip for trip in old.keys() & new.keys() if old[trip]["observe_key"] != new[trip]["observe_key"]}
    rules, config = (before.provenance.get(name) != provenance.get(name) for name in SAME_CIRCUMSTANCES)
    return {
        "since": before.version,
        "added": named(new, new.keys() - old.keys()),
        "removed": named(old, old.keys() - new.keys()),
        "observed_anew": named(new, anew),
        "rules_changed": rules and "rules" in before.provenance,
        "car_file_changed": config,
    }


def cells_changed(before: Mapping[str, CellSums], after: Mapping[str, CellSums]) -> dict[str, Any]:
    """Tell how the level and how many cells changed from one set of trips to another."""
    every = {**before, **after}
    old, new = (np.array([trip in sums for trip in every], np.bool_) for sums in (before, after))
    try:
        return _told(compare_trips(list(every.values()), old, new, GRID).difference)
    except ScienceError:
        return {}  # too little is known of both, which the versions' numbers of cells show


def maps_changed(before: EfficiencyMap, after: EfficiencyMap) -> dict[str, Any]:
    """Tell the same of two maps whose trips are no longer known one by one."""
    try:
        return _told(compare_maps(before, after))
    except ScienceError:
        return {}  # as above


def _told(difference: MapDifference) -> dict[str, Any]:
    return {
        "level": difference.level,
        "level_sd": difference.level_sd,
        "common_cells": len(difference.rpm),
        "changed_cells": int(difference.significant.sum()),
    }
