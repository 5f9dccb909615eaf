"""One simulated trip, whole: logger image, car file, elevation table and the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import ScienceError
from app.science.vehicle.model import Injection, Mounting, Vehicle
from app.science.virtualcar import image, receiver, sensors
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.driver import Drive, drive
from app.science.virtualcar.elevation import elevation_csv, elevation_nodes
from app.science.virtualcar.receiver import Outage
from app.science.virtualcar.road import Road, build_road
from app.science.virtualcar.specification import Simulation
from app.science.virtualcar.truth import truth_columns

# Injectors a little larger than the thesis' 0.008 l/s: with 60 kW and Table 4.1 a pulse at full load would otherwise
# last 17.1 ms, which the logger's 16 bits of 250 ns can't hold.
DEFAULT_CAR = Vehicle(
    owner="Ponthy",
    make="Smart",
    model="Roadster",
    year="2004",
    color="grey",
    engine_type="698cc Inline 3 Turbo Suprex",
    displacement_l=0.698,
    max_power_w=60e3,
    max_power_rpm=5250.0,
    max_torque_nm=110.0,
    max_torque_rpm=4500.0,
    wheel_radius_m=0.29545,
    gear_ratios=(13.25, 9.604, 7.37, 5.796, 4.208, 3.23),
    crr=0.010,
    injection=Injection(litres_per_second=0.0085),
)
_MESSAGES = ("ACC: read timeout", "SD: write retried", "GPS: framing error")


@dataclass(frozen=True, slots=True)
class SimulatedTrip:
    """A trip's image and everything that is true about it.

    Attributes
    ----------
    image : bytes
        Logger image.
    car_xml : bytes
        The car, without fault: its numbers are those of the simulation.
    elevation_csv : bytes
        Elevation table along the driven road.
    truth : mapping of str to array, shape (n,)
        Columns of ``truth.parquet``. ``t_s`` is the logger's milliseconds since ``clock_start_ms``, over 1000; the
        first packet of a trip, an accelerometer sample, is stamped with exactly that time zero.
    summary : dict
        Content of ``truth.json``.
    vehicle : Vehicle
        With the mounting that was drawn; give it to further trips of the same car.
    drive : Drive
        The full-rate drive behind the truth.
    road : Road
    """

    image: bytes
    car_xml: bytes
    elevation_csv: bytes
    truth: Mapping[str, FloatArray]
    summary: Mapping[str, Any]
    vehicle: Vehicle
    drive: Drive
    road: Road


def simulate(spec: Simulation) -> SimulatedTrip:
    """Drive the virtual car and log it.

    Everything follows from the spec: the same spec gives the same bytes.

    Raises
    ------
    ScienceError
        When the trip is too short to start and stop in, or the car's injectors are too small for the engine.
    """
    if spec.duration_s < 60.0:
        raise ScienceError("A simulated trip needs at least 60 s to start, drive and stop in.")
    road_rng, driver_rng, car_rng, sensor_rng, gps_rng, logger_rng = np.random.default_rng(spec.seed).spawn(6)
    vehicle = spec.vehicle if spec.vehicle is not None else replace(DEFAULT_CAR, mounting=_random_mounting(car_rng))
    if not vehicle.gear_ratios:
        raise ScienceError("The car has no gears: give its XML a <transmission> with gear ratios.")
    bias = car_rng.uniform(0.05, 0.2, 3) * car_rng.choice([-1.0, 1.0], 3)
    road = build_road(spec.route, spec.duration_s, road_rng)
    driven = drive(road, vehicle, spec.engine, spec.route, spec.duration_s, driver_rng)
    outages = receiver.draw_outages(spec.duration_s, spec.sensors, spec.route == "tunnel", gps_rng)
    columns = truth_columns(driven, road, bias, spec.start_lat_deg, spec.start_lon_deg, spec.truth_step_s)
    nodes = elevation_nodes(
        road, float(driven.distance_m[-1]), spec.start_lat_deg, spec.start_lon_deg, spec.elevation_rounding_m
    )
    return SimulatedTrip(
        image=_image(spec, vehicle, road, driven, bias, outages, sensor_rng, gps_rng, logger_rng),
        car_xml=car_xml(vehicle),
        elevation_csv=elevation_csv(nodes),
        truth=columns,
        summary=_summary(spec, vehicle, road, driven, bias, outages),
        vehicle=vehicle,
        drive=driven,
        road=road,
    )


def join_images(trips: list[SimulatedTrip]) -> bytes:
    """One card with several trips: each starts its clock anew where the one before ended.

    Only the last may have been simulated with zero padding.
    """
    return b"".join(trip.image for trip in trips)


def _random_mounting(rng: np.random.Generator) -> Mounting:
    roll, yaw = rng.uniform(-np.pi, np.pi, 2)
    return Mounting(float(roll), float(rng.uniform(-0.4, 0.4)), float(yaw), float(rng.uniform(0.98, 1.02)))


def _image(
    spec: Simulation,
    vehicle: Vehicle,
    road: Road,
    driven: Drive,
    bias: FloatArray,
    outages: list[Outage],
    sensor_rng: np.random.Generator,
    gps_rng: np.random.Generator,
    logger_rng: np.random.Generator,
) -> bytes:
    encoder = image.Encoder(big_endian=spec.image.big_endian, clock_start_ms=spec.image.clock_start_ms)
    samples = sensors.accelerometer(driven, road, vehicle, bias, spec.sensors, sensor_rng)
    ticks = sensors.wheel_ticks(driven, vehicle.vss_m_per_tick)
    pulses = sensors.injector_pulses(driven, vehicle)
    texts = receiver.packets_of(_bursts(spec, road, driven, outages, gps_rng), spec.image.gps_packet_bytes)
    skew_ms = _moments(spec.duration_s, spec.image.skew_every_s, logger_rng)
    error_ms = _moments(spec.duration_s, spec.image.error_every_s, logger_rng)
    return image.interleave(
        [
            encoder.accelerometer(samples.ms, samples.counts),
            encoder.ticks(ticks.eighths_ms),
            encoder.pulses(pulses.ms, pulses.counts),
            encoder.skews(skew_ms, logger_rng.integers(1, 4, len(skew_ms))),
            *image.gps_packets([1000.0 * t for t in texts[0]], texts[1]),
            *image.error_packets([float(t) for t in error_ms], [str(logger_rng.choice(_MESSAGES)) for _ in error_ms]),
        ],
        spec.image.zero_padding_bytes,
    )


def _bursts(
    spec: Simulation, road: Road, driven: Drive, outages: list[Outage], rng: np.random.Generator
) -> list[receiver.SentenceBurst]:
    t = np.arange(0.0, spec.duration_s, receiver.FIX_STEP_S)
    s = np.interp(t, driven.t_s, driven.distance_m)
    north, east = np.interp(s, road.distance_m, road.north_m), np.interp(s, road.distance_m, road.east_m)
    place = receiver.to_geographic(north, east, spec.start_lat_deg, spec.start_lon_deg)
    return receiver.fixes(
        t,
        place[:, 0],
        place[:, 1],
        np.interp(s, road.distance_m, road.alt_m),
        np.interp(t, driven.t_s, driven.speed_mps),
        np.interp(s, road.distance_m, road.heading_rad),
        started_at_utc_s=spec.started_at_utc_s,
        outages=outages,
        settings=spec.sensors,
        rng=rng,
    )


def _moments(duration_s: float, every_s: float, rng: np.random.Generator) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Random moments in trip milliseconds, in order."""
    count = int(rng.poisson(duration_s / every_s)) if every_s > 0 else 0
    return np.sort(rng.integers(1000, int(duration_s * 1000), count))


def _summary(
    spec: Simulation, vehicle: Vehicle, road: Road, driven: Drive, bias: FloatArray, outages: list[Outage]
) -> dict[str, Any]:
    distance = float(driven.distance_m[-1])
    fuel = float(driven.fuel_energy_j[-1])
    passed = road.stop_m < distance
    return {
        "seed": spec.seed,
        "route": spec.route,
        "duration_s": spec.duration_s,
        "started_at_utc_s": spec.started_at_utc_s,
        "start": {"lat_deg": spec.start_lat_deg, "lon_deg": spec.start_lon_deg},
        "time_zero": "t_s is logger milliseconds since clock_start_ms, over 1000",
        "distance_m": distance,
        "fuel_energy_j": fuel,
        "fuel_l": fuel / vehicle.fuel_energy_j_per_l,
        "bias_mps2": {axis: float(b) for axis, b in zip("ijk", bias, strict=True)},
        "mounting": asdict(vehicle.mounting),
        "vehicle": asdict(vehicle) | {"mass_kg": vehicle.mass_kg},
        "engine": asdict(spec.engine),
        "sensors": asdict(spec.sensors),
        "image": asdict(spec.image),
        "gps_outages_s": [[o.begin_s, o.end_s] for o in outages],
        "stops_m": road.stop_m[passed].tolist(),
    }
