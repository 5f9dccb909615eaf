"""How far a run of the observer is from the truth of a virtual trip."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from app.imports.elevation import read_elevation
from app.science.arrays import FloatArray
from app.science.engine.accuracy import map_error
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.engine.points import OperatingPoints
from app.science.logger.decode import decode_image
from app.science.logger.recording import Recording
from app.science.observer.observe import observe
from app.science.observer.result import Observation
from app.science.observer.tuning import DEFAULT, Tuning
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip

SETTLE_S = 5.0
PROPELLING_W = 2000.0
IN_UNITS = {
    "speed_mps": 1.0,
    "pitch_rad": 180.0 / np.pi,
    "thrust_n": 1.0,
    "engine_speed_radps": 1.0,
    "fuel_power_w": 1.0,
    "efficiency": 1.0,
}
"""Columns that are compared, and the factor to the unit in which the error is told: m/s, °, N, rad/s, W, 1."""
WHILE_PROPELLING = frozenset({"thrust_n", "engine_speed_radps", "fuel_power_w", "efficiency"})


def observed_errors(
    trip: SimulatedTrip,
    *,
    tuning: Tuning = DEFAULT,
    without: frozenset[str] = frozenset(),
    filter: str = "ekf",  # noqa: A002 - the name the contract gives it
    smooth: bool = True,
) -> dict[str, float]:
    """Observe a virtual trip and return the root mean square error of each column of `IN_UNITS`.

    With ``<column> inside`` the share of the truth inside two standard deviations in percent, ``map`` and ``cells``
    the error of the efficiency map and its trusted cells, ``events`` the measurement events.
    """
    recording = _recording(trip)
    vehicle = read_vehicle(trip.car_xml)
    elevation = read_elevation(trip.elevation_csv)
    seen = observe(
        recording, vehicle, elevation=elevation, tuning=tuning, without=without, filter=filter, smooth=smooth
    )
    errors = state_errors(seen, trip)
    grid = CellGrid()
    sums = accumulate(operating_points(seen, recording, vehicle), grid)
    found = map_error(build_map(sums, grid, vehicle), trip.engine.map_efficiency)
    return errors | {"map": found.rmse, "cells": float(found.cells), "events": float(seen.events)}


def observed_points(trip: SimulatedTrip) -> OperatingPoints:
    """Return the operating points of a virtual trip as the observer sees them."""
    recording, vehicle = _recording(trip), read_vehicle(trip.car_xml)
    seen = observe(recording, vehicle, elevation=read_elevation(trip.elevation_csv))
    return operating_points(seen, recording, vehicle)


def state_errors(seen: Observation, trip: SimulatedTrip) -> dict[str, float]:
    """Return the errors and the coverage of the states alone."""
    t = seen.columns["t_s"]
    settled = (t > SETTLE_S) & (t < t[-1] - SETTLE_S)
    propelling = settled & (_true("power_w", trip, t) > PROPELLING_W)
    errors: dict[str, float] = {}
    for column, factor in IN_UNITS.items():
        error = seen.columns[column] - _true(column, trip, t)
        counted = (propelling if column in WHILE_PROPELLING else settled) & np.isfinite(error)
        errors[column] = factor * float(np.sqrt(np.mean(error[counted] ** 2)))
        sd = seen.columns.get(f"{column}_sd")
        if sd is not None:
            errors[f"{column} inside"] = 100.0 * float(np.mean(np.abs(error[counted]) <= 2.0 * sd[counted]))
    return errors


def _true(column: str, trip: SimulatedTrip, t: FloatArray) -> FloatArray:
    return np.interp(t, trip.truth["t_s"], trip.truth[column])


@lru_cache(maxsize=1)
def _decoded(image: bytes) -> Recording:
    return decode_image(image).recordings[0]


def _recording(trip: SimulatedTrip) -> Recording:
    return _decoded(trip.image)
