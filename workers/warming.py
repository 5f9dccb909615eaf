"""Filling the kernel cache, so that the first trip of a person doesn't wait for a compiler."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from app.exports.parquet import states_parquet
from app.imports.elevation import read_elevation
from app.science.battery.circuit import Hysteresis
from app.science.battery.config import ESTIMATORS
from app.science.battery.estimate import estimate
from app.science.battery.virtual.a123 import CELL, first_guess
from app.science.battery.virtual.ageing import DEFAULT_MAP
from app.science.battery.virtual.pack import VirtualPack, virtual_pack
from app.science.eco.score import score_trip
from app.science.engine.cells import accumulate, build_map
from app.science.engine.document import map_document
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.fingerprint import science_fingerprint
from app.science.logger.decode import ImageDecoder
from app.science.logger.recording import Recording
from app.science.observer.observe import observe
from app.science.observer.tuning import DEFAULT
from app.science.optimal.problem import Accelerate, PolynomialEngine, Road, RoadLoad, Route, Transmission
from app.science.optimal.solve import solve
from app.science.virtualcar.engine import SMART_FULL_LOAD, TABLE_4_1_PHI
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import DEFAULT_CAR, Simulation

CHUNK_BYTES = 1 << 20
LOWEST_PRIORITY = 19


def warm() -> int:
    """Take a short virtual trip through everything a real one goes through, once per version of the science."""
    return _once("warm", _take_a_trip)


def warm_filters() -> int:
    """Do the same for what nobody gets at once, such as filters and drives; it gives way to all other work."""
    os.nice(LOWEST_PRIORITY)
    rooms = {"filters": _try_filters, "drives": _try_drives, "scores": _try_scores, "batteries": _try_batteries}
    return max(_once(f"warm-{name}", work) for name, work in rooms.items())


def _once(name: str, work: Callable[[], None]) -> int:
    folder = os.environ.get("NUMBA_CACHE_DIR")
    mark = None if folder is None else Path(folder) / science_fingerprint() / name
    if mark is not None and mark.exists():
        return 0
    work()
    if mark is not None:
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
    return 0


def _take_a_trip() -> None:
    trip = simulate(Simulation(duration_s=90.0, seed=7))
    for recording in _recordings(trip):
        observation = observe(recording, trip.vehicle, elevation=read_elevation(trip.elevation_csv))
        points = operating_points(observation, recording, trip.vehicle)
        build_map(accumulate(points, CellGrid()), CellGrid(), trip.vehicle)
        states_parquet(observation)


def _try_filters() -> None:
    trip = simulate(Simulation(duration_s=60.0, seed=7))
    richer = replace(DEFAULT, thrust_order=2, fuel_power_order=2, engine_speed_order=2)
    for recording in _recordings(trip):
        observe(recording, trip.vehicle, filter="sr-ekf", tuning=richer)


def _try_drives() -> None:
    load = RoadLoad(
        mass_kg=DEFAULT_CAR.mass_kg,
        accelerated_mass_kg=DEFAULT_CAR.accelerated_mass_kg(0),
        cd=DEFAULT_CAR.cd,
        frontal_area_m2=DEFAULT_CAR.frontal_area_m2,
        crr=DEFAULT_CAR.crr,
        air_density_kgpm3=DEFAULT_CAR.air_density_kgpm3,
        gravity_mps2=DEFAULT_CAR.gravity_mps2,
        wheel_radius_m=DEFAULT_CAR.wheel_radius_m,
    )
    engine = PolynomialEngine.of_phi(TABLE_4_1_PHI, (1000.0, 6000.0), (10.0, 110.0), SMART_FULL_LOAD)
    gears = Transmission("gears", DEFAULT_CAR.gear_ratios, neutral=True)
    start = Accelerate(load, engine, gears, 10.0, 20.0)
    for time_s in (None, 6.0, 30.0):
        solve(replace(start, time_s=time_s))
    road = Road((0.0, 300.0, 600.0), (0.0, 3.0, 0.0), (18.0, 14.0, 14.0))
    way = Route(load, engine, gears, road, 12.0, 12.0, 6.0, brake_max_n=4000.0)
    for time_s in (None, 47.0):
        solve(replace(way, max_time_s=time_s))


def _try_scores() -> None:
    trip = simulate(Simulation(duration_s=180.0, seed=7, route="town"))
    for recording in _recordings(trip):
        observation = observe(recording, trip.vehicle, elevation=read_elevation(trip.elevation_csv))
        points = operating_points(observation, recording, trip.vehicle)
        made = build_map(accumulate(points, CellGrid()), CellGrid(), trip.vehicle)
        score_trip(observation.columns, trip.vehicle, map_document(made, {}))


def _try_batteries() -> None:
    crooked = replace(CELL, hysteresis=Hysteresis(voltage_v=0.01, rate=50.0))
    for cell, estimator in ((crooked, ESTIMATORS[0]), *((CELL, name) for name in ESTIMATORS)):
        data = virtual_pack(VirtualPack(days=0.02, cell=cell, fade=DEFAULT_MAP))
        estimate(data.record, replace(first_guess(cell, start_after_s=0.0), estimator=estimator))


def _recordings(trip: SimulatedTrip) -> Iterator[Recording]:
    return ImageDecoder().trips(trip.image[at : at + CHUNK_BYTES] for at in range(0, len(trip.image), CHUNK_BYTES))
