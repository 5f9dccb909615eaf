"""The eco-score of a trip: how much less it could have taken over its own road, limits, stops and times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.accelerations import acceleration, rises, table_4_2
from app.science.eco.advice import advice
from app.science.eco.along import along
from app.science.eco.best import Car, Solver, plan_of
from app.science.eco.doubt import LoadDoubts, Pair, doubts, fuel_share, joined
from app.science.eco.driven import (
    AT_REST_MPS,
    Driven,
    brakes_n,
    highest_rpm,
    lowest_rpm,
    slowest_mps,
    stretches,
)
from app.science.eco.full_load import full_load_seen
from app.science.eco.known_engine import KnownEngine, known_engine
from app.science.eco.losses import Drive
from app.science.eco.ratios import with_gears
from app.science.eco.result import Acceleration, Estimate, NotScored, Section, Standing, TripScore
from app.science.eco.ride import burnt
from app.science.eco.road import Freedom, KnownLimits
from app.science.eco.search_engine import engine_near
from app.science.eco.sections import Compared, compare, missed_percent
from app.science.eco.tally import Scale, by_cell, lost_pieces, parts_of, summed
from app.science.eco.words import assumptions, engine_words, warnings
from app.science.progress import Progress, between, silent
from app.science.vehicle.model import Vehicle

ORDINARY_DOUBTS = LoadDoubts()
ORDINARY_FREEDOM = Freedom()


@dataclass(frozen=True, slots=True)
class _Ready:
    """All that the sections are compared with."""

    engine: KnownEngine
    car: Car
    highest_nm: float
    slowest_mps: float

    @property
    def trip(self) -> Driven:
        """As driven."""
        return self.engine.trip


def score_trip(
    columns: Mapping[str, FloatArray],
    vehicle: Vehicle,
    map_document: Mapping[str, Any] | None,
    *,
    speed_limit: KnownLimits | None = None,
    load_doubts: LoadDoubts = ORDINARY_DOUBTS,
    freedom: Freedom = ORDINARY_FREEDOM,
    solver: Solver = plan_of,
    progress: Progress = silent,
) -> TripScore:
    """Compare a trip with the best drive over the same road in the same time.

    Parameters
    ----------
    columns : mapping of arrays, shape (n,)
        Those of ``states.parquet``, NaN where unknown.
    vehicle : Vehicle
        Gears that its file lacks are read off the drive.
    map_document : mapping or None
        ``map.json`` of the car. Where it carries no formula, the trip's own fuel stands in, and where there is none, an
        ordinary engine.
    speed_limit : KnownLimits, optional
        The road's own limits; without them the speeds driven nearby stand for them.
    load_doubts : LoadDoubts
        How sure mass, rolling resistance and drag are.
    freedom : Freedom
        How much the best drive may differ.
    solver : callable
        Finds the best drive of a section.
    progress : callable

    Returns
    -------
    TripScore

    Raises
    ------
    NotScored
        When the trip or every section can't be compared; the message says why.
    """
    geared, car = with_gears(columns, vehicle)
    ready = _ready(geared, car, map_document, freedom)
    found = stretches(ready.trip.ride, ready.slowest_mps)
    ends = np.cumsum([0.0, *(float(stretch.rows.stop - stretch.rows.start) for stretch in found)])
    shares = 0.9 * ends / max(float(ends[-1]), 1.0)
    results = [
        compare(ready.trip, stretch, ready.car, solver, between(progress, begin, end), freedom, speed_limit)
        for stretch, begin, end in zip(found, shares[:-1].tolist(), shares[1:].tolist(), strict=True)
    ]
    compared = [one for one in results if isinstance(one, Compared)]
    if not compared:
        reasons = [one.reason for one in results if isinstance(one, Section)]
        why = reasons[0] if reasons else "the car never drove in gear."
        raise NotScored(f"No section of this trip could be compared with a best drive: {why}")
    progress(0.9)
    done = _assembled(ready, vehicle, results, compared, load_doubts)
    progress(1.0)
    return done


def _ready(
    columns: Mapping[str, FloatArray], vehicle: Vehicle, map_document: Mapping[str, Any] | None, freedom: Freedom
) -> _Ready:
    known = known_engine(columns, vehicle, map_document)
    trip, plain = known.trip, known.plain
    took = burnt(trip.ride, trip.load, plain)
    if not trip.fuel_known:
        known = replace(known, trip=replace(trip, measured_w=burnt(trip.ride, trip.load, known.known.model).fuel_w))
    low, high = lowest_rpm(trip), max(plain.rpm[1], highest_rpm(trip))
    most = full_load_seen(known.cells, trip.ride, took.torque_nm)
    engine = engine_near(known.known.model, (low, high), most)
    brakes = brakes_n(trip, took.brake_w)
    car = Car(trip.load, engine, known.known.model, vehicle.gear_ratios, brakes, freedom.rolls_in_neutral)
    torques = known.cells.nm[np.isfinite(known.cells.efficiency)]
    highest_nm = float(torques.max()) if known.source == "map" else max(nm for _, nm in most)
    return _Ready(known, car, highest_nm, slowest_mps(vehicle, low))


def _assembled(
    ready: _Ready,
    vehicle: Vehicle,
    results: Sequence[Compared | Section],
    compared: Sequence[Compared],
    load_doubts: LoadDoubts,
) -> TripScore:
    trip, load, engine = ready.trip, ready.trip.load, ready.engine
    driven_j, best_j = (sum(drive.fuel_j for drive in drives) for drives in _drives(compared))
    measured_j = sum(one.section.measured_j for one in compared)
    litre_j = vehicle.fuel_energy_j_per_l
    scale = Scale(measured_j / driven_j / litre_j, driven_j)
    energies = parts_of(compared)
    pieces = lost_pieces(compared, load.accelerated_mass_kg)
    cells, elsewhere = by_cell(compared, pieces, engine.plain, scale)
    measured_w = np.concatenate([trip.measured_w[one.rows] for one in compared])
    rides = [joined([drive.ride for drive in drives]) for drives in _drives(compared)]
    pair = Pair(rides[0], measured_w if trip.fuel_known else None, rides[1])
    doubt = doubts(pair, load, engine.known, engine.cells, ready.highest_nm, load_doubts)
    if engine.source == "trip":
        doubt["sections"] = missed_percent(compared)
    saved, sd = 100.0 * (1.0 - best_j / driven_j), hypot(*doubt.values())
    level = 0.0 if trip.fuel_known else fuel_share(pair.driven, load, engine.known)
    trip_j = trip.measured_j(slice(None))
    losses = scale.losses(summed(energies))
    standing = _standing(trip, litre_j)
    rows = _accelerations(compared, ready)
    parts = iter(scale.losses(energy) for energy in energies)
    return TripScore(
        score=Estimate(100.0 - saved, sd),
        saved_percent=Estimate(saved, sd),
        saved_l=Estimate(0.01 * saved * measured_j / litre_j, 0.01 * hypot(sd, saved * level) * measured_j / litre_j),
        driven_j=driven_j,
        best_j=best_j,
        measured_j=measured_j,
        trip_l=trip_j / litre_j,
        scored_m=sum(one.road.distance_m[-1] for one in compared),
        scored_s=sum(one.driven.time_s for one in compared),
        scored_percent=100.0 * measured_j / trip_j,
        doubts=doubt,
        parts=losses,
        cells=cells,
        elsewhere=elsewhere,
        sections=tuple(
            replace(one.section, parts=next(parts)) if isinstance(one, Compared) else one for one in results
        ),
        accelerations=rows,
        table=table_4_2(rows),
        standing=standing,
        advice=advice(compared, losses, standing, scale),
        assumptions=assumptions(ready.car, load_doubts, engine),
        warnings=(
            *engine_words(engine, vehicle, ready.car),
            *warnings(engine.plain, compared, results, measured_j, trip_j),
        ),
        along=along(compared, [piece * scale.l_per_j for piece in pieces], ready.car),
        engine=engine.source,
        fuel_measured=trip.fuel_known,
    )


def _drives(compared: Sequence[Compared]) -> tuple[list[Drive], list[Drive]]:
    return [one.driven for one in compared], [one.best for one in compared]


def _accelerations(compared: Sequence[Compared], ready: _Ready) -> tuple[Acceleration, ...]:
    found = []
    for one in compared:
        for first, last in rises(one.driven.ride.t_s, one.driven.ride.speed_mps, ready.slowest_mps):
            ride = one.driven.ride.part(slice(first, last))
            found.append(acceleration(Drive(ride, burnt(ride, ready.car.load, ready.car.model)), ready.car))
    return tuple(found)


def _standing(trip: Driven, litre_j: float) -> Standing:
    still = trip.ride.speed_mps < AT_REST_MPS
    running = still & (trip.measured_w > 0.0)
    energy = trip.measured_j(running)
    stops = int(np.count_nonzero(np.diff(np.concatenate(([False], still))) & np.append(still[1:], False)))
    return Standing(stops, float(trip.ride.dt_s[running].sum()), energy, energy / litre_j)
