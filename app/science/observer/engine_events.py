"""Events of the two engine blocks: fuel energy and power, engine angle and speed."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.logger.recording import Recording
from app.science.observer.gears import NODE_SPACING_S
from app.science.observer.pair_kernels import PAIR_LEVEL, PAIR_NODE, PAIR_RATE, PAIR_REANCHOR
from app.science.observer.prepass import (
    FUEL_CUT_GAP_S,
    engine_speed_before_filtering,
    pulses_between,
    speed_before_filtering,
)
from app.science.observer.timeline import Timeline
from app.science.observer.tuning import Tuning
from app.science.vehicle.model import Vehicle

Part = tuple[FloatArray, int, FloatArray, FloatArray]
NO_FUEL_VARIANCE_W2 = 100.0**2
STOICHIOMETRIC_AIR_TO_FUEL = 14.7
WHEELS_TELL_WITHIN = 0.03
RADPS_PER_RPM = 2.0 * np.pi / 60.0


def fuel_events(recording: Recording, vehicle: Vehicle, tuning: Tuning, node_t_s: FloatArray) -> list[Part]:
    """Return the measurements of {fuel energy, fuel power} (Sebesta 2010, 1.18: INJ_duration).

    A pulse completes the energy of its cycle, and stands in for pulses lost just before it. In a gap longer than that
    of a slowly idling engine no fuel flows.
    """
    parts: list[Part] = []
    pulses = recording.get("injector_pulse_s")
    if pulses is not None and len(pulses) > 1:
        energy = vehicle.fuel_energy_of_pulse_j(pulses.value)
        lost = pulses_between(pulses.t_s) - 1
        energy[1:-1] += lost[1:-1] * 0.5 * (energy[:-2] + energy[2:])
        parts.append(_part(pulses.t_s, PAIR_LEVEL, np.cumsum(energy), tuning.r_fuel_energy))
        parts.append(_no_fuel(node_t_s, pulses.t_s, lost))
    rate = recording.get("fuel_rate_lph")
    power_per_rate = vehicle.fuel_energy_j_per_l / 3600.0
    if rate is None and "maf_gps" in recording:
        rate = recording["maf_gps"]
        power_per_rate = vehicle.fuel_energy_j_per_l / vehicle.fuel_density_kg_per_l * 1e-3 / STOICHIOMETRIC_AIR_TO_FUEL
    if rate is not None and pulses is None:
        parts.append(_part(rate.t_s, PAIR_RATE, rate.value * power_per_rate, tuning.r_fuel_power))
    return parts


def _no_fuel(node_t_s: FloatArray, pulse_t_s: FloatArray, lost: IntArray) -> Part:
    after = np.clip(np.searchsorted(pulse_t_s, node_t_s), 1, len(pulse_t_s) - 1)
    since, until = node_t_s - pulse_t_s[after - 1], pulse_t_s[after] - node_t_s
    outside = (node_t_s < pulse_t_s[0]) | (node_t_s > pulse_t_s[-1])
    inside_gap = (since + until > FUEL_CUT_GAP_S) & (since > 0.1) & (until > NODE_SPACING_S) & (lost[after] == 0)
    t = node_t_s[inside_gap | (outside & (np.abs(since) > 0.1) & (np.abs(until) > 0.1))]
    return _part(t, PAIR_RATE, np.zeros(len(t)), NO_FUEL_VARIANCE_W2)


def engine_speed_events(recording: Recording, vehicle: Vehicle, tuning: Tuning, timeline: Timeline) -> list[Part]:
    """Return the measurements of {engine angle, engine speed} (Sebesta 2010, 1.18: INJ_time).

    Every pulse is one more multiple of the pulse angle, except across a gap, where the engine may have turned
    without fuel: there the angle is let go, and the wheels tell the engine's speed as long as a gear is in.
    """
    parts: list[Part] = []
    pulses = recording.get("injector_pulse_s")
    if pulses is not None and len(pulses) > 1:
        turned = pulses_between(pulses.t_s)
        angle = np.cumsum(turned).astype(np.float64) * vehicle.engine_angle_per_pulse_rad
        after_gap = pulses.t_s[1:][(np.diff(pulses.t_s) > FUEL_CUT_GAP_S) & (turned[1:] == 1)]
        parts.append(_part(after_gap, PAIR_REANCHOR, np.zeros(len(after_gap)), 0.0))
        parts.append(_part(pulses.t_s, PAIR_LEVEL, angle, tuning.r_engine_angle))
        parts.append(_turned_by_the_wheels(recording, vehicle, timeline))
    speed = recording.get("engine_speed_rpm")
    if speed is not None and len(speed):
        parts.append(_part(speed.t_s, PAIR_RATE, speed.value * RADPS_PER_RPM, tuning.r_engine_speed))
    return parts


def _turned_by_the_wheels(recording: Recording, vehicle: Vehicle, timeline: Timeline) -> Part:
    nodes = timeline.node_t_s
    omega = engine_speed_before_filtering(nodes, recording, vehicle)
    speed = speed_before_filtering(nodes, recording, vehicle)
    if omega is None or speed is None:
        return _part(np.zeros(0), PAIR_RATE, np.zeros(0), 0.0)
    ratios = np.array((0.0, *vehicle.gear_ratios)) / vehicle.wheel_radius_m
    cut = np.isnan(omega) & (timeline.gear > 0)
    turned = speed[cut] * ratios[timeline.gear[cut]]
    return nodes[cut], PAIR_RATE, turned, (WHEELS_TELL_WITHIN * turned) ** 2


def merged(parts: list[Part], node_t_s: FloatArray) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
    """Merge parts and nodes into ``t, kind, y, r`` sorted by time; at equal times a node comes last."""
    everything = [*parts, _part(node_t_s, PAIR_NODE, np.zeros(len(node_t_s)), 0.0)]
    t = np.concatenate([part[0] for part in everything])
    order = np.argsort(t, kind="stable")
    kind = np.concatenate([np.full(len(part[0]), part[1], np.int64) for part in everything])
    y = np.concatenate([part[2] for part in everything])
    r = np.concatenate([part[3] for part in everything])
    return t[order], kind[order], y[order], r[order]


def _part(t: FloatArray, kind: int, y: FloatArray, r: float) -> Part:
    return t, kind, y, np.full(len(t), r)
