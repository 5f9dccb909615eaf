"""What the observer loses with each sensor, and gains with more, against the full set on one virtual hour, smoothed.

The seed was never used for tuning.
"""

from __future__ import annotations

import numpy as np

from app.cli.bench.figure import Figure
from app.cli.bench.modes import MODES, WITHOUT_ELEVATION
from app.cli.bench.truth import SETTLE_S, state_errors
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.arrays import FloatArray
from app.science.engine.accuracy import map_error
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.logger.decode import decode_image
from app.science.observer.observe import observe
from app.science.observer.result import Observation
from app.science.roads.projection import LocalPlane
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

FRESH_SEED = 9301
DURATION_S = 3600.0
DRIVING_MPS = 3.0
FULL = "all sensors"
STATES = (
    ("speed_mps", "speed", "m/s"),
    ("pitch_rad", "pitch", "°"),
    ("thrust_n", "thrust", "N"),
    ("heading_rad", "heading", "°"),
    ("position_m", "position", "m"),
)


def measure() -> list[Figure]:
    """Return each mode's errors, the share of the truth inside two sigma, map error and trusted cells."""
    note(f"an hour with seed {FRESH_SEED}")
    trip = simulate(Simulation(duration_s=DURATION_S, seed=FRESH_SEED))
    figures: list[Figure] = []
    full: dict[str, float] = {}
    for name in MODES:
        errors = mode_errors(trip, name)
        full = full or errors
        figures += _figures(name, errors, full)
    return figures


def layout(found: list[Figure]) -> list[list[str]]:
    """Return one row for each mode; in brackets the share of the truth inside two sigma, in percent."""
    value = {one.name: one.value for one in found}
    rows = [["sensors", *(f"{label}, {unit}" for _, label, unit in STATES), "map", "trusted cells"]]
    for name in MODES:
        row = [name]
        for _, label, _ in STATES:
            error, inside = value.get(f"{name}: {label}"), value.get(f"{name}: {label}, inside two sigma")
            row.append("-" if error is None or inside is None else f"{error:.3g} ({inside:.0f})")
        rows.append([*row, f"{value[f'{name}: map']:.4f}", f"{value[f'{name}: trusted cells']:.0f}"])
    return rows


def mode_errors(trip: SimulatedTrip, name: str) -> dict[str, float]:
    """Observe a trip with its sensors changed; errors and coverage by column, map error and trusted cells."""
    recording, vehicle = MODES[name](decode_image(trip.image).recordings[0], trip), read_vehicle(trip.car_xml)
    elevation = None if name in WITHOUT_ELEVATION else read_elevation(trip.elevation_csv)
    seen = observe(recording, vehicle, elevation=elevation)
    grid = CellGrid()
    sums = accumulate(operating_points(seen, recording, vehicle), grid)
    found = map_error(build_map(sums, grid, vehicle), trip.engine.map_efficiency)
    return state_errors(seen, trip) | place_errors(seen, trip) | {"map": found.rmse, "cells": float(found.cells)}


def place_errors(seen: Observation, trip: SimulatedTrip) -> dict[str, float]:
    """Return errors and coverage of heading, °, while driving, and of the position in the plane, m; NaN if unknown."""
    columns = seen.columns
    t = columns["t_s"]
    settled = (t > SETTLE_S) & (t < t[-1] - SETTLE_S)
    driving = settled & (_true("speed_mps", trip, t) > DRIVING_MPS)
    heading = np.angle(np.exp(1j * (columns["heading_rad"] - _true("heading_rad", trip, t))))
    plane = LocalPlane(float(trip.truth["lat_deg"][0]), float(trip.truth["lon_deg"][0]))
    at, truly = (
        plane.forward(lat, lon)
        for lat, lon in (
            (columns["lat_deg"], columns["lon_deg"]),
            (_true("lat_deg", trip, t), _true("lon_deg", trip, t)),
        )
    )
    north, east = (at.north_m - truly.north_m)[settled], (at.east_m - truly.east_m)[settled]
    sds = columns["north_m_sd"][settled], columns["east_m_sd"][settled]
    inside = [np.mean(np.abs(error) <= 2.0 * sd) for error, sd in zip((north, east), sds, strict=True)]
    return {
        "heading_rad": float(np.degrees(np.sqrt(np.mean(heading[driving] ** 2)))),
        "heading_rad inside": 100.0 * float(np.mean(np.abs(heading) <= 2.0 * columns["heading_rad_sd"], where=driving)),
        "position_m": float(np.sqrt(np.mean(north**2 + east**2))),
        "position_m inside": 100.0 * float(np.mean(inside)),
    }


def _figures(name: str, errors: dict[str, float], full: dict[str, float]) -> list[Figure]:
    rows = []
    for column, label, unit in STATES:
        if np.isfinite(errors[column]):
            rows.append(Figure(f"{name}: {label}", errors[column], unit, full[column], FULL))
            share, of_all = errors[f"{column} inside"], full[f"{column} inside"]
            rows.append(Figure(f"{name}: {label}, inside two sigma", share, "%", of_all, FULL, "higher"))
    rows.append(Figure(f"{name}: map", errors["map"], "1", full["map"], FULL))
    rows.append(Figure(f"{name}: trusted cells", errors["cells"], "1", full["cells"], FULL, "higher"))
    return rows


def _true(column: str, trip: SimulatedTrip, t_s: FloatArray) -> FloatArray:
    return np.interp(t_s, trip.truth["t_s"], trip.truth[column])
