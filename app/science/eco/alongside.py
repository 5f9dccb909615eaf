"""Driven and best drive beside each other along the road, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from app.science.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Along:
    """Driven and best beside each other along the scored road, each array of shape (n,).

    A row belongs to a place; a stop between two sections leaves two rows of nearly the same place.

    Attributes
    ----------
    distance_m : array
        Of the trip.
    section : array
        Index of the section, from 0.
    elevation_m, limit_mps : array
        The road as the best drive sees it.
    t_s, speed_mps, gear, engine_speed_radps, torque_nm, fuel_power_w : array
        As driven; fuel power by the engine's model.
    best_t_s, best_speed_mps, best_gear, best_engine_speed_radps, best_torque_nm : array
    best_fuel_power_w, best_brake_n : array
        The best drive; ``best_t_s`` is a time of the trip, too, and begins with the section as driven.
    best_costate : array
        λ_v of the best drive, J s/m; NaN where it isn't known.
    lost_lpkm : array
        Litres lost at this place, per kilometre.
    """

    distance_m: FloatArray
    section: FloatArray
    elevation_m: FloatArray
    limit_mps: FloatArray
    t_s: FloatArray
    speed_mps: FloatArray
    gear: FloatArray
    engine_speed_radps: FloatArray
    torque_nm: FloatArray
    fuel_power_w: FloatArray
    best_t_s: FloatArray
    best_speed_mps: FloatArray
    best_gear: FloatArray
    best_engine_speed_radps: FloatArray
    best_torque_nm: FloatArray
    best_fuel_power_w: FloatArray
    best_brake_n: FloatArray
    best_costate: FloatArray
    lost_lpkm: FloatArray

    def columns(self) -> dict[str, FloatArray]:
        """Return the arrays by name, as a table keeps them."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def from_columns(cls, columns: Mapping[str, FloatArray]) -> Along:
        """Return what `columns` gave."""
        return cls(**{field.name: np.asarray(columns[field.name], dtype=np.float64) for field in fields(cls)})

    @classmethod
    def nothing(cls) -> Along:
        """Return no rows."""
        return cls(**{field.name: np.empty(0) for field in fields(cls)})
