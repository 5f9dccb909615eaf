"""How close the observer comes to known truth on virtual hours, beside the thesis' own values in the same run.

The seeds here were never used for tuning; the tuning was done with seeds 101 and 102.
"""

from __future__ import annotations

import numpy as np

from app.cli.bench.figure import Figure
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.engine.accuracy import map_error
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.logger.decode import decode_image
from app.science.observer.observe import observe
from app.science.observer.tuning import DEFAULT, THESIS_2010, Tuning
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

FRESH_SEEDS = (9101, 9102, 9103)
SETTLE_S = 5.0
PROPELLING_W = 2000.0
STATES = (
    ("speed_mps", "speed", 1.0, "m/s", "at most 0.03"),
    ("pitch_rad", "pitch", 180.0 / np.pi, "°", "at most 0.25"),
    ("thrust_n", "thrust while propelling", 1.0, "N", "at most 85"),
)


def measure() -> list[Figure]:
    """Return errors and coverage, smoothed, with GPS and elevation and with GPS alone, for every fresh seed."""
    figures: list[Figure] = []
    for seed in FRESH_SEEDS:
        note(f"simulating and observing an hour with seed {seed}")
        trip = simulate(Simulation(duration_s=3600.0, seed=seed))
        for label, without, goal in (
            ("GPS + elevation", frozenset[str](), "at most 0.010"),
            ("GPS only", frozenset({"dem"}), "at most 0.012"),
        ):
            ours, thesis = (_errors(trip, tuning, without) for tuning in (DEFAULT, THESIS_2010))
            figures += _figures(f"seed {seed}, {label}", ours, thesis, goal)
    return figures


def _figures(where: str, ours: dict[str, float], thesis: dict[str, float], map_goal: str) -> list[Figure]:
    rows = []
    for column, name, _, unit, goal in STATES:
        against = "thesis-2010"
        rows.append(Figure(f"{where}: {name}, RMSE", ours[column], unit, thesis[column], against, goal=goal))
        inside = f"{column} inside"
        rows.append(
            Figure(
                f"{where}: {name}, truth inside two sigma", ours[inside], "%", thesis[inside], against, "higher",
                goal="90 to 99 %",
            )
        )  # fmt: skip
    rows.append(Figure(f"{where}: map, RMSE of η", ours["map"], "1", thesis["map"], "thesis-2010", goal=map_goal))
    rows.append(
        Figure(
            f"{where}: trusted cells", ours["cells"], "1", thesis["cells"], "thesis-2010", "higher", goal="at least 550"
        )
    )
    return rows


def _errors(trip: SimulatedTrip, tuning: Tuning, without: frozenset[str]) -> dict[str, float]:
    recording = decode_image(trip.image).recordings[0]
    vehicle = read_vehicle(trip.car_xml)
    elevation = read_elevation(trip.elevation_csv)
    seen = observe(recording, vehicle, elevation=elevation, tuning=tuning, without=without)
    t = seen.columns["t_s"]
    true = {name: np.interp(t, trip.truth["t_s"], trip.truth[name]) for name, *_ in (*STATES, ("power_w",))}
    settled = (t > SETTLE_S) & (t < t[-1] - SETTLE_S)
    errors: dict[str, float] = {}
    for column, _, factor, _, _ in STATES:
        counted = settled & (true["power_w"] > PROPELLING_W) if column == "thrust_n" else settled
        error = (seen.columns[column] - true[column])[counted]
        errors[column] = factor * float(np.sqrt(np.mean(error**2)))
        errors[f"{column} inside"] = 100.0 * float(
            np.mean(np.abs(error) <= 2.0 * seen.columns[f"{column}_sd"][counted])
        )
    grid = CellGrid()
    sums = accumulate(operating_points(seen, recording, vehicle), grid)
    found = map_error(build_map(sums, grid, vehicle), trip.engine.map_efficiency)
    return errors | {"map": found.rmse, "cells": float(found.cells)}
