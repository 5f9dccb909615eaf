"""How well measured engines are found again from driving: map, best point, full load, idle, each against the truth.

The plain way is what a spreadsheet does with the same points: the mean efficiency of each cell, its highest cell, and
the highest torque of each engine speed.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from app.cli.bench.engine_cars import ENGINE_CARS, EngineCar
from app.cli.bench.figure import Figure
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.arrays import FloatArray
from app.science.engine.accuracy import map_error
from app.science.engine.cells import accumulate, build_map, merge, trusted_cells
from app.science.engine.efficiency_map import CellGrid, CellSums, EfficiencyMap
from app.science.engine.envelope import envelope
from app.science.engine.full_load import full_load_curve
from app.science.engine.idle import IdleSums, idle_of, idling
from app.science.engine.moments import MomentSums, merge_moments, moments_of
from app.science.engine.operating import operating_points
from app.science.engine.reading import peak
from app.science.logger.decode import decode_image
from app.science.observer.observe import observe
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import RouteName, Simulation

FOLDER = Path(os.environ.get("PONTHY_SHARED_DATA", Path(__file__).resolve().parents[4] / "shared" / "data"))
TABLES = "engine-maps-nrel"
GRID = CellGrid()
BIAS_MPS2 = (0.10, -0.12, 0.15)
DRIVING: tuple[tuple[RouteName, int], ...] = (
    ("full-load", 7101),
    ("full-load", 7102),
    ("mixed", 7103),
    ("mixed", 7104),
    ("mixed", 7105),
    ("mixed", 7106),
)
"""An hour each, with seeds that nothing was tuned with."""


@dataclass(frozen=True, slots=True)
class Driven:
    """What some hours of driving leave of an engine, and the truth."""

    sums: CellSums
    moments: MomentSums
    idle: tuple[IdleSums, ...]
    engine: EngineModel


@dataclass(frozen=True, slots=True)
class Found:
    """A map's distance from the truth; efficiencies as fractions of 1."""

    rmse: float
    peak_rpm: float
    peak_nm: float
    given_away: float
    full_load: float


def measure() -> list[Figure]:
    """Return the distances of every engine's map from the truth; none where the tables are not on this machine."""
    folder = FOLDER / TABLES
    if not folder.exists():
        note(
            f"the engines' tables are not on this machine (looked in {FOLDER}; PONTHY_SHARED_DATA says where they are)"
        )
        return []
    figures: list[Figure] = []
    for car in ENGINE_CARS:
        note(f"driving {len(DRIVING)} hours with the engine {car.name}")
        figures += _figures(car, drive(car, folder, DRIVING))
    return figures


def drive(car: EngineCar, folder: Path, driving: Sequence[tuple[RouteName, int]], duration_s: float = 3600.0) -> Driven:
    """Drive, log, decode and observe; routes with their seeds."""
    engine = car.engine(folder)
    sums, moments, idle = [], [], []
    for route, seed in driving:
        spec = Simulation(
            duration_s=duration_s,
            seed=seed,
            route=route,
            vehicle=car.vehicle,
            engine=engine,
            bias_mps2=BIAS_MPS2,
        )
        trip = simulate(spec)
        recording, vehicle = decode_image(trip.image).recordings[0], read_vehicle(trip.car_xml)
        seen = observe(recording, vehicle, elevation=read_elevation(trip.elevation_csv))
        points = operating_points(seen, recording, vehicle)
        sums.append(accumulate(points, GRID))
        moments.append(moments_of(points))
        idle.append(idling(seen, recording, vehicle))
    return Driven(merge(sums), merge_moments(moments), tuple(idle), trip.engine)


def found_map(car: EngineCar, driven: Driven) -> EfficiencyMap:
    """Return the map as Ponthy makes it."""
    full_load = full_load_curve(driven.moments)
    return build_map(driven.sums, GRID, car.vehicle, full_load, idle_of(driven.idle, car.vehicle))


def compared(found: EfficiencyMap, engine: EngineModel) -> Found:
    """Hold a map against the truth; its full load only where it was reached."""
    best = peak(found)
    if best is None or found.full_load_reached is None or not found.full_load_reached.any():
        return Found(np.nan, np.nan, np.nan, np.nan, np.nan)
    reached = found.full_load_reached
    return Found(
        map_error(found, engine.map_efficiency).rmse,
        *_from_best(best.rpm, best.nm, engine),
        _worst(found.full_load_rpm[reached], found.full_load_nm[reached], engine),
    )


def plain(car: EngineCar, driven: Driven, found: EfficiencyMap) -> Found:
    """Hold against the truth what a spreadsheet makes of the same cells."""
    sums = driven.sums
    trusted = trusted_cells(sums, GRID)
    efficiency = np.where(trusted, sums.efficiency_sum / sums.n, np.nan)
    bare = replace(build_map(sums, GRID, car.vehicle), efficiency=efficiency)
    highest = int(np.nanargmax(efficiency))
    seen = envelope(sums, trusted, GRID)
    reached = found.full_load_rpm[np.asarray(found.full_load_reached)]
    return Found(
        map_error(bare, driven.engine.map_efficiency).rmse,
        *_from_best(float(bare.rpm[highest]), float(bare.nm[highest]), driven.engine),
        _worst(reached, np.interp(reached, seen.rpm, seen.nm), driven.engine),
    )


def _from_best(rpm: float, nm: float, engine: EngineModel) -> tuple[float, float, float]:
    """Return how far a place is from the truly best one, in rpm and Nm, and how much efficiency it gives away."""
    speeds = np.arange(engine.full_load[0][0], engine.full_load[-1][0] + 1.0, 10.0)
    torques = np.arange(5.0, max(top for _, top in engine.full_load) + 0.5, 0.5)
    field = engine.map_efficiency(*np.meshgrid(speeds, torques))
    row, column = np.unravel_index(int(np.nanargmax(field)), field.shape)
    possible = min(nm, float(engine.full_load_nm(np.array(rpm))))
    there = float(engine.map_efficiency(np.array(rpm), np.array(possible)))
    return rpm - float(speeds[column]), nm - float(torques[row]), float(np.nanmax(field)) - there


def _worst(rpm: FloatArray, nm: FloatArray, engine: EngineModel) -> float:
    return float(np.abs(nm / engine.full_load_nm(rpm) - 1.0).max())


def _figures(car: EngineCar, driven: Driven) -> list[Figure]:
    found = found_map(car, driven)
    ours, other = compared(found, driven.engine), plain(car, driven, found)
    idle = found.idle
    rows = [
        ("map, RMSE of η", ours.rmse, other.rmse, "1", "mean of ratios", "at most 0.010"),
        ("best point, off by", abs(ours.peak_rpm), abs(other.peak_rpm), "rpm", "highest cell", "at most 150 rpm"),
        ("best point, off by", abs(ours.peak_nm), abs(other.peak_nm), "Nm", "highest cell", "at most 6 Nm"),
        ("best point, gives away", 100.0 * ours.given_away, 100.0 * other.given_away, "points", "highest cell", ""),
        ("full load, worst", 100.0 * ours.full_load, 100.0 * other.full_load, "%", "highest cells", "at most 4 %"),
    ]
    figures = [
        Figure(f"{car.name}: {name}", value, unit, against, way, goal=goal)
        for name, value, against, unit, way, goal in rows
    ]
    if idle is not None:
        truth = driven.engine.idle_fuel_power_w
        error = 100.0 * abs(idle.fuel_power_w / truth - 1.0)
        scatter = 100.0 * idle.fuel_power_sd_w / truth
        figures.append(Figure(f"{car.name}: idle fuel, error", error, "%", scatter, "scatter of single moments"))
    return figures


def layout(found: list[Figure]) -> list[list[str]]:
    """Return one row for each engine; in brackets the plain way's figure."""
    engines = list(dict.fromkeys(one.name.partition(": ")[0] for one in found))
    names = list(dict.fromkeys((one.name.partition(": ")[2], one.unit) for one in found))
    rows = [["engine", *(f"{name}, {unit}".removesuffix(", 1") for name, unit in names)]]
    for engine in engines:
        own = {(one.name.partition(": ")[2], one.unit): one for one in found if one.name.startswith(f"{engine}: ")}
        rows.append(
            [engine, *(f"{own[key].value:.3g} ({own[key].reference:.3g})" if key in own else "-" for key in names)]
        )
    return rows
