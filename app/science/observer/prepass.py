"""Speed of car and engine read straight off a recording, before any filtering."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.logger.recording import Recording
from app.science.vehicle.model import Vehicle

FUEL_CUT_GAP_S = 0.22
NEIGHBOURS_AGREE = 0.15
MOST_LOST_PULSES = 8
WINDOW_S = 0.15


def speed_before_filtering(t_s: FloatArray, recording: Recording, vehicle: Vehicle) -> FloatArray | None:
    """Return the car's speed at the given times from ticks or a speed signal, m/s; None without either."""
    ticks = recording.get("vss_tick")
    if ticks is not None and len(ticks) > 1:
        distance = np.cumsum(ticks.value) * vehicle.vss_m_per_tick
        behind, ahead = (np.interp(t_s + d, ticks.t_s, distance) for d in (-WINDOW_S, WINDOW_S))
        return np.asarray((ahead - behind) / (2.0 * WINDOW_S))
    for name, scale in (("speed_mps", vehicle.speed_scale), ("gnss_speed_mps", 1.0)):
        measured = recording.get(name)
        if measured is not None and len(measured):
            return scale * np.interp(t_s, measured.t_s, measured.value)
    return None


def engine_speed_before_filtering(t_s: FloatArray, recording: Recording, vehicle: Vehicle) -> FloatArray | None:
    """Return the engine's speed at the given times from pulses or a signal, rad/s; NaN in a fuel cut; None without."""
    pulses = recording.get("injector_pulse_s")
    if pulses is not None and len(pulses) > 2:
        angle = np.cumsum(pulses_between(pulses.t_s)) * vehicle.engine_angle_per_pulse_rad
        behind, ahead = (np.interp(t_s + d, pulses.t_s, angle) for d in (-WINDOW_S, WINDOW_S))
        omega = (ahead - behind) / (2.0 * WINDOW_S)
        after = np.clip(np.searchsorted(pulses.t_s, t_s), 1, len(pulses) - 1)
        omega[np.diff(pulses.t_s)[after - 1] > FUEL_CUT_GAP_S] = np.nan
        return np.asarray(omega)
    measured = recording.get("engine_speed_rpm")
    if measured is not None and len(measured):
        return np.interp(t_s, measured.t_s, measured.value) * (2.0 * np.pi / 60.0)
    return None


def pulses_between(pulse_t_s: FloatArray) -> IntArray:
    """Return how many pulses each pulse stands for, shape (n,): itself and those lost just before it.

    A damaged image loses single pulses. Where the intervals before and after a longer one agree and it is a small
    multiple of them, the engine turned on and the pulses between are missing; anything else is taken as it is.
    """
    stands_for = np.ones(len(pulse_t_s), np.int64)
    if len(pulse_t_s) < 4:
        return stands_for
    interval = np.diff(pulse_t_s)
    before, own, after = interval[:-2], interval[1:-1], interval[2:]
    usual = 0.5 * (before + after)
    multiple = np.round(own / usual).astype(np.int64)
    steady = np.abs(before - after) < NEIGHBOURS_AGREE * usual
    whole = np.abs(own / usual - multiple) < NEIGHBOURS_AGREE
    lost = steady & whole & (multiple > 1) & (multiple <= MOST_LOST_PULSES) & (usual < FUEL_CUT_GAP_S)
    stands_for[2:-1][lost] = multiple[lost]
    return stands_for
