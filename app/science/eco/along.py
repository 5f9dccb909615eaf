"""Driven and best drives on one grid of places, to be drawn and played."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.best import Car
from app.science.eco.losses import Drive
from app.science.eco.result import Along
from app.science.eco.road import travelled_m
from app.science.eco.sections import Compared
from app.science.eco.worth import costate

SPACING_M = 10.0


def along(compared: Sequence[Compared], lost_l: Sequence[FloatArray], car: Car) -> Along:
    """Return all scored sections one after the other.

    Parameters
    ----------
    compared : sequence of Compared
    lost_l : sequence of array
        For each section the litres lost at the pieces of the driven ride.
    car : Car
        With which the best drives were looked for.
    """
    parts = [_columns(number, one, lost, car) for number, (one, lost) in enumerate(zip(compared, lost_l, strict=True))]
    return Along.from_columns({name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def _columns(number: int, one: Compared, lost_l: FloatArray, car: Car) -> dict[str, FloatArray]:
    length = one.road.distance_m[-1]
    edges = np.linspace(0.0, length, max(round(length / SPACING_M), 2) + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    limits = np.array(one.road.speed_limit_mps)
    cell = np.clip(np.searchsorted(one.road.distance_m, middle, side="right") - 1, 0, len(limits) - 1)
    own = travelled_m(one.driven.ride)
    lost = np.diff(np.interp(edges, own / own[-1] * length, np.concatenate(([0.0], np.cumsum(lost_l)))))
    driven, best = _at(one.driven, middle, length), _at(one.best, middle, length)
    return {
        "distance_m": one.section.from_m + middle,
        "section": np.full(len(middle), float(number)),
        "elevation_m": np.interp(middle, one.road.distance_m, one.road.elevation_m),
        "limit_mps": limits[cell],
        **{name: driven[name] for name in driven if name != "brake_n"},
        **{f"best_{name}": values for name, values in best.items()},
        "best_costate": _between_pieces(one.best, costate(one.best, car), middle, length),
        "lost_lpkm": lost / np.diff(edges) * 1000.0,
    }


def _between_pieces(drive: Drive, values: FloatArray, places_m: FloatArray, length_m: float) -> FloatArray:
    """Return at places what is known at the middles of a drive's pieces."""
    edges = travelled_m(drive.ride)
    edges = edges / edges[-1] * length_m
    return np.asarray(np.interp(places_m, 0.5 * (edges[1:] + edges[:-1]), values))


def _at(drive: Drive, places_m: FloatArray, length_m: float) -> dict[str, FloatArray]:
    """Return a drive at places: time and speed between its pieces, the rest of the piece there."""
    ride, took = drive.ride, drive.took
    edges = travelled_m(ride)
    edges = edges / edges[-1] * length_m
    row = np.clip(np.searchsorted(edges, places_m, side="right") - 1, 0, len(ride.t_s) - 1)
    times = np.append(ride.t_s, ride.t_s[-1] + ride.dt_s[-1])
    return {
        "t_s": np.interp(places_m, edges, times),
        "speed_mps": _between_pieces(drive, ride.speed_mps, places_m, length_m),
        "gear": ride.gear[row].astype(np.float64),
        "engine_speed_radps": ride.engine_radps[row],
        "torque_nm": took.torque_nm[row],
        "fuel_power_w": took.fuel_w[row],
        "brake_n": took.brake_w[row] / np.maximum(ride.speed_mps[row], 0.1),
    }
