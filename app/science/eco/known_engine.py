"""What is known of the engine that a trip is scored with: by the car's map, by the trip's own fuel, or by neither."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.correction import Learnt, learn
from app.science.eco.doubt import Known
from app.science.eco.driven import AT_REST_MPS, Driven, driven_trip, highest_rpm, lowest_rpm
from app.science.eco.fuel_model import FuelModel, fuel_model_of_map
from app.science.eco.ordinary import Ordinary, of_trip, ordinary
from app.science.eco.result import EngineFrom
from app.science.eco.ride import TURNING_RADPS, burnt
from app.science.engine.document import read_map_document
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.vehicle.model import Vehicle

LEAST_IDLE_S = 5.0
NO_CELLS = (np.inf, -np.inf)


@dataclass(frozen=True, slots=True)
class KnownEngine:
    """A trip as driven, and the engine that both drives are charged with.

    Attributes
    ----------
    trip : Driven
    plain : FuelModel
        Before the trip's own fuel corrected it.
    known : Known
    cells : EfficiencyMap
        Without cells where the car has no map.
    source : EngineFrom
    ordinary : Ordinary or None
        What was assumed where the map carries no formula.
    """

    trip: Driven
    plain: FuelModel
    known: Known
    cells: EfficiencyMap
    source: EngineFrom
    ordinary: Ordinary | None = None


def known_engine(
    columns: Mapping[str, FloatArray], vehicle: Vehicle, document: Mapping[str, Any] | None
) -> KnownEngine:
    """Return the trip with the best that is known of its engine.

    The map's formula, where the map carries one; else a formula fitted to the trip's own fuel, with seven measured
    engines as its prior; else the mean of those.

    Parameters
    ----------
    columns : mapping of arrays
        States of the trip.
    vehicle : Vehicle
        With its gears.
    document : mapping or None
        ``map.json``; None where the car has none.

    Raises
    ------
    NotScored
        When the trip tells too little of its motion or its engine's speed.
    """
    by_map = None if document is None else fuel_model_of_map(document)
    cells = read_map_document(document or {"cell": {"rpm": CellGrid().rpm, "nm": CellGrid().nm}, "cells": []})
    if by_map is None:
        return _without_map(columns, vehicle, cells)
    trip = driven_trip(columns, vehicle, by_map.idle_w)
    torques = cells.nm[np.isfinite(cells.efficiency)]
    seen = float(torques.min()), float(torques.max())
    return KnownEngine(trip, by_map, _learnt(trip, by_map, seen), cells, "map")


def _without_map(columns: Mapping[str, FloatArray], vehicle: Vehicle, cells: EfficiencyMap) -> KnownEngine:
    idle_w = _idle_w(columns)
    start = ordinary(vehicle, idle_w)
    trip = driven_trip(columns, vehicle, start.model.idle_w)
    start = start.between(lowest_rpm(trip), highest_rpm(trip))
    if not trip.fuel_known:
        return KnownEngine(trip, start.model, start, cells, "ordinary", start)
    plain = of_trip(start, trip.ride, trip.measured_w, trip.load)
    return KnownEngine(trip, plain, _learnt(trip, plain, NO_CELLS), cells, "trip", start)


def _learnt(trip: Driven, plain: FuelModel, seen_nm: tuple[float, float]) -> Learnt:
    took = burnt(trip.ride, trip.load, plain)
    return learn(plain, trip.ride, took, trip.measured_w if trip.fuel_known else None, seen_nm)


def _idle_w(columns: Mapping[str, FloatArray]) -> float | None:
    """Return what was measured while the engine idled at rest, W; None where that was hardly ever."""
    fuel = columns["fuel_power_w"]
    idles = (columns["speed_mps"] < AT_REST_MPS) & (columns["engine_speed_radps"] > TURNING_RADPS) & (fuel > 0.0)
    seconds = float(np.gradient(columns["t_s"])[idles].sum())
    return float(np.median(fuel[idles])) if seconds >= LEAST_IDLE_S else None
