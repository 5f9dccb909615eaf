"""What a display on the dashboard shows while a trip is played (Sebesta 2010, 5.1.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.alongside import Along
from app.science.vehicle.model import Vehicle

NEEDED = ("t_s", "speed_mps", "thrust_n", "thrust_n_sd", "pitch_rad", "fuel_power_w", "gear", "engine_speed_radps")
STEP_S = 0.5
WINDOW_S = 8.0
"""What the meter looks back on: long enough for single pulses of the injectors to even out."""
LEAST_FUEL_W = 1500.0
"""Mean fuel power of a window below which there is no fuel to speak of: it was cut, or the engine just idled."""


@dataclass(frozen=True, slots=True)
class Meters:
    """The readings over time, each array of shape (n,), NaN where there is nothing to show.

    Attributes
    ----------
    t_s : array
        In steps of `STEP_S`.
    speed_mps, gear, engine_speed_radps : array
        As driven.
    target_mps, limit_mps, best_gear : array
        At the same place of the road: the best drive's speed and gear, and the limit it keeps.
    costate : array
        λ_v of the best drive there, J s/m: the fuel that one more metre a second is worth.
    efficiency, efficiency_sd : array
        Work at the wheels over fuel in the last `WINDOW_S`; what is stored as speed and height counts.
    to_speed, to_height, to_resistance : array
        The same split by where the work went; the three add up to it. Below 0 where a store gave some back.
    """

    t_s: FloatArray
    speed_mps: FloatArray
    gear: FloatArray
    engine_speed_radps: FloatArray
    target_mps: FloatArray
    limit_mps: FloatArray
    best_gear: FloatArray
    costate: FloatArray
    efficiency: FloatArray
    efficiency_sd: FloatArray
    to_speed: FloatArray
    to_height: FloatArray
    to_resistance: FloatArray


def meters(states: Mapping[str, FloatArray], vehicle: Vehicle, along: Along | None) -> Meters:
    """Return what the meters show all along a trip.

    Parameters
    ----------
    states : mapping
        Columns of ``states.parquet``: those of `NEEDED`.
    vehicle : Vehicle
        Whose resistances split the work.
    along : Along or None
        The best drive beside the driven one; None where the trip has no score.
    """
    t, v = states["t_s"], np.nan_to_num(states["speed_mps"])
    now = np.arange(t[0], t[-1], STEP_S)
    thrust, weight = np.nan_to_num(states["thrust_n"]), vehicle.mass_kg * vehicle.gravity_mps2
    pitch = np.nan_to_num(states["pitch_rad"])

    def lately(power: FloatArray) -> FloatArray:
        """Return the energy of the last seconds."""
        total = np.concatenate(([0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(t))))
        return np.asarray(np.interp(now, t, total) - np.interp(now - WINDOW_S, t, total))

    fuel = lately(np.maximum(np.nan_to_num(states["fuel_power_w"]), 0.0))
    fuel[fuel < LEAST_FUEL_W * np.minimum(WINDOW_S, now - t[0] + STEP_S)] = np.nan
    work = lately(thrust * v) / fuel
    height = lately(weight * np.sin(pitch) * v) / fuel
    resistance = lately((vehicle.drag_area_kgpm * v**2 + weight * vehicle.crr * np.cos(pitch)) * v) / fuel
    target, limit, gear, costate = _beside(now, along)
    return Meters(
        t_s=now,
        speed_mps=np.interp(now, t, v),
        gear=_held(now, t, states["gear"]),
        engine_speed_radps=np.interp(now, t, np.nan_to_num(states["engine_speed_radps"])),
        target_mps=target,
        limit_mps=limit,
        best_gear=gear,
        costate=costate,
        efficiency=work,
        efficiency_sd=lately(np.nan_to_num(states["thrust_n_sd"]) * v) / fuel,
        to_speed=work - height - resistance,
        to_height=height,
        to_resistance=resistance,
    )


def _beside(now: FloatArray, along: Along | None) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return target speed, limit, gear and costate of the best drive at the places where the car was."""
    shown = [np.full(len(now), np.nan) for _ in range(4)]
    if along is None:
        return shown[0], shown[1], shown[2], shown[3]
    for number in np.unique(along.section):
        rows = along.section == number
        t = along.t_s[rows]
        inside = (now >= t[0]) & (now <= t[-1])
        shown[0][inside] = np.interp(now[inside], t, along.best_speed_mps[rows])
        shown[1][inside] = _held(now[inside], t, along.limit_mps[rows])
        shown[2][inside] = _held(now[inside], t, along.best_gear[rows])
        shown[3][inside] = np.interp(now[inside], t, along.best_costate[rows])
    return shown[0], shown[1], shown[2], shown[3]


def _held(now: FloatArray, t_s: FloatArray, values: FloatArray) -> FloatArray:
    """Return each value until the next one comes."""
    return np.asarray(values[np.clip(np.searchsorted(t_s, now, side="right") - 1, 0, len(t_s) - 1)])
