"""The logger of the virtual car: everything its sensors said, in one image."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.vehicle.model import Vehicle
from app.science.virtualcar import image, receiver, sensors
from app.science.virtualcar.driver import Drive
from app.science.virtualcar.geography import place_of
from app.science.virtualcar.road import Road
from app.science.virtualcar.specification import Simulation

_COMPLAINTS = ("ACC: read timeout", "SD: write retried", "GPS: framing error")


def record(
    spec: Simulation,
    vehicle: Vehicle,
    road: Road,
    drive: Drive,
    bias_mps2: FloatArray,
    outages: tuple[receiver.Outage, ...],
    rng: np.random.Generator,
) -> bytes:
    """Log a drive; the image without the unwritten rest of the card.

    The first packet is an accelerometer sample stamped with ``clock_start_ms``, trip time zero. Skew packets and error
    messages come at random moments and change nothing: the logger's own clock is the time of the truth.
    """
    sensor_rng, gps_rng, logger_rng = rng.spawn(3)
    encoder = image.Encoder(big_endian=spec.image.big_endian, clock_start_ms=spec.image.clock_start_ms)
    samples = sensors.accelerometer(drive, road, vehicle, bias_mps2, spec.sensors, sensor_rng)
    pulses = sensors.injector_pulses(drive, vehicle)
    gps = receiver.chunks_of(_sentences(spec, road, drive, outages, gps_rng), spec.image.gps_packet_bytes)
    skew_ms = _moments(spec.duration_s, spec.image.skew_every_s, logger_rng)
    complaint_ms = _moments(spec.duration_s, spec.image.error_every_s, logger_rng)
    complaints = [str(logger_rng.choice(_COMPLAINTS)) for _ in complaint_ms]
    return image.interleave(
        [
            encoder.accelerometer(samples.ms, samples.counts),
            encoder.ticks(sensors.wheel_ticks(drive, vehicle.vss_m_per_tick)),
            encoder.pulses(pulses.ms, pulses.counts),
            encoder.skews(skew_ms, logger_rng.integers(1, 4, len(skew_ms))),
            *image.gps_packets([1000.0 * chunk.t_s for chunk in gps], [chunk.text for chunk in gps]),
            *image.error_packets(complaint_ms.tolist(), complaints),
        ]
    )


def _sentences(
    spec: Simulation, road: Road, drive: Drive, outages: tuple[receiver.Outage, ...], rng: np.random.Generator
) -> list[receiver.TextChunk]:
    t = np.arange(0.0, spec.duration_s, receiver.FIX_STEP_S)
    s = np.interp(t, drive.t_s, drive.distance_m)
    return receiver.sentences(
        t,
        place_of(road.at(s, road.north_m), road.at(s, road.east_m), spec.start_lat_deg, spec.start_lon_deg),
        road.at(s, road.alt_m),
        np.interp(t, drive.t_s, drive.speed_mps),
        road.at(s, road.heading_rad),
        started_at_utc_s=spec.started_at_utc_s,
        outages=outages,
        settings=spec.sensors,
        rng=rng,
    )


def _moments(duration_s: float, every_s: float, rng: np.random.Generator) -> IntArray:
    """Random moments in trip milliseconds, in order; none where ``every_s`` is 0."""
    count = int(rng.poisson(duration_s / every_s)) if every_s > 0 else 0
    return np.sort(rng.integers(1000, int(duration_s * 1000), count))
