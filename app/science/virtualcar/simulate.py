"""One simulated trip, whole: logger image, car file, elevation table and the truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import ScienceError
from app.science.vehicle.model import Mounting, Vehicle
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.driver import Drive, drive
from app.science.virtualcar.elevation import elevation_csv, elevation_nodes
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.receiver import draw_outages
from app.science.virtualcar.recorder import record
from app.science.virtualcar.road import Road, build_road
from app.science.virtualcar.specification import DEFAULT_CAR, Simulation
from app.science.virtualcar.truth import truth_columns, truth_summary

SHORTEST_TRIP_S = 60.0


@dataclass(frozen=True, slots=True)
class SimulatedTrip:
    """A trip's image and everything that is true about it.

    Attributes
    ----------
    image : bytes
        Logger image, with the zeros of the unwritten card behind ``packet_bytes`` bytes of packets.
    packet_bytes : int
    car_xml : bytes
        The car as it is: its numbers are those of the simulation.
    elevation_csv : bytes
        Elevation table along the driven road: ``lat_deg,lon_deg,alt_m,way``.
    truth : mapping of str to array, shape (n,)
        Columns of ``truth.parquet``. ``t_s`` is the logger's milliseconds since ``clock_start_ms``, over 1000; the
        first packet of a trip, an accelerometer sample, is stamped with exactly that time zero.
    summary : mapping
        Content of ``truth.json``.
    vehicle : Vehicle
        With the mounting that was drawn; give it to further trips of the same car.
    engine : EngineModel
        With the full load that was driven; ``engine.map_efficiency`` is the map to find.
    drive : Drive
        The drive behind the truth, every 5 ms.
    road : Road
    """

    image: bytes
    packet_bytes: int
    car_xml: bytes
    elevation_csv: bytes
    truth: Mapping[str, FloatArray]
    summary: Mapping[str, Any]
    vehicle: Vehicle
    engine: EngineModel
    drive: Drive
    road: Road


def simulate(spec: Simulation) -> SimulatedTrip:
    """Drive the virtual car and log it; the same spec gives the same bytes.

    Parameters
    ----------
    spec : Simulation

    Raises
    ------
    ScienceError
        When the trip is too short to start, drive and stop in, or the car has no gears.
    """
    if spec.duration_s < SHORTEST_TRIP_S:
        raise ScienceError(f"A simulated trip of {spec.duration_s:g} s is too short: give it {SHORTEST_TRIP_S:g} s.")
    car_rng, road_rng, driver_rng, outage_rng, logger_rng = np.random.default_rng(spec.seed).spawn(5)
    vehicle = spec.vehicle if spec.vehicle is not None else replace(DEFAULT_CAR, mounting=_any_mounting(car_rng))
    if not vehicle.gear_ratios:
        raise ScienceError("The car has no gears: give its XML a <transmission> with the total ratio of each gear.")
    engine = (spec.engine or EngineModel.for_vehicle(vehicle)).limited_by_injectors(vehicle)
    drawn_mps2 = car_rng.uniform(0.05, 0.2, 3) * car_rng.choice([-1.0, 1.0], 3)
    bias_mps2 = drawn_mps2 if spec.bias_mps2 is None else np.array(spec.bias_mps2)
    road = build_road(spec.route, spec.duration_s, road_rng)
    driven = drive(road, vehicle, engine, spec.route, spec.duration_s, driver_rng)
    outages = draw_outages(spec.duration_s, spec.sensors, spec.route, outage_rng)
    packets = record(spec, vehicle, road, driven, bias_mps2, outages, logger_rng)
    lat_deg, lon_deg = spec.start_lat_deg, spec.start_lon_deg
    nodes = elevation_nodes(road, float(driven.distance_m[-1]), lat_deg, lon_deg, spec.elevation_rounding_m)
    return SimulatedTrip(
        image=packets + bytes(spec.image.zero_padding_bytes),
        packet_bytes=len(packets),
        car_xml=car_xml(vehicle),
        elevation_csv=elevation_csv(nodes),
        truth=truth_columns(driven, road, bias_mps2, lat_deg, lon_deg, spec.truth_step_s),
        summary=truth_summary(spec, vehicle, engine, road, driven, bias_mps2, outages),
        vehicle=vehicle,
        engine=engine,
        drive=driven,
        road=road,
    )


def join_images(trips: Sequence[SimulatedTrip], zero_padding_bytes: int = 0) -> bytes:
    """Put several trips on one card: the logger starts its clock anew where the one before ended."""
    return b"".join(trip.image[: trip.packet_bytes] for trip in trips) + bytes(zero_padding_bytes)


def _any_mounting(rng: np.random.Generator) -> Mounting:
    roll, yaw = rng.uniform(-np.pi, np.pi, 2)
    return Mounting(float(roll), float(rng.uniform(-0.4, 0.4)), float(yaw), float(rng.uniform(0.98, 1.02)))
