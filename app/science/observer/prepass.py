"""Speed of car and engine read straight off a recording, before any filtering."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.logger.recording import Recording
from app.science.vehicle.model import Vehicle

FUEL_CUT_GAP_S = 0.22
WINDOW_S = 0.15


def speed_before_filtering(t_s: FloatArray, recording: Recording, vehicle: Vehicle) -> FloatArray | None:
    """Return the car's speed at the given times from ticks or a speed signal, m/s; None without either."""
    ticks = recording.get("vss_tick")
    if ticks is not None and len(ticks) > 1:
        distance = np.cumsum(ticks.value) * vehicle.vss_m_per_tick
        behind, ahead = (np.interp(t_s + d, ticks.t_s, distance) for d in (-WINDOW_S, WINDOW_S))
        return np.asarray((ahead - behind) / (2.0 * WINDOW_S))
    for name in ("speed_mps", "gnss_speed_mps"):
        measured = recording.get(name)
        if measured is not None and len(measured):
            return np.interp(t_s, measured.t_s, measured.value)
    return None


def engine_speed_before_filtering(t_s: FloatArray, recording: Recording, vehicle: Vehicle) -> FloatArray | None:
    """Return the engine's speed at the given times from pulses or a signal, rad/s; NaN in a fuel cut; None without."""
    pulses = recording.get("injector_pulse_s")
    if pulses is not None and len(pulses) > 2:
        angle = np.arange(len(pulses)) * vehicle.engine_angle_per_pulse_rad
        behind, ahead = (np.interp(t_s + d, pulses.t_s, angle) for d in (-WINDOW_S, WINDOW_S))
        omega = (ahead - behind) / (2.0 * WINDOW_S)
        after = np.clip(np.searchsorted(pulses.t_s, t_s), 1, len(pulses) - 1)
        omega[np.diff(pulses.t_s)[after - 1] > FUEL_CUT_GAP_S] = np.nan
        return np.asarray(omega)
    measured = recording.get("engine_speed_rpm")
    if measured is not None and len(measured):
        return np.interp(t_s, measured.t_s, measured.value) * (2.0 * np.pi / 60.0)
    return None
