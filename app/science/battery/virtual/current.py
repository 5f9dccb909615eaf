"""What a plug-in hybrid asks of one cell of its battery over a driving cycle (MAUTC-2010-02, part 3, 4.2, fig. 27)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray

GRAVITY_MPS2 = 9.81
STEP_S = 1.0


@dataclass(frozen=True, slots=True)
class Cells:
    """What the pack is made of.

    Attributes
    ----------
    pack_wh : float
        Of the whole pack (4.2).
    cell_ah, cell_v : float
        Nominal, of one cell (4.1).
    resistance_ohm : float
        What power that flows for a while sees in a cell: R + R_r of Table 7.
    """

    pack_wh: float = 16_000.0
    cell_ah: float = 2.0
    cell_v: float = 3.3
    resistance_ohm: float = 0.019

    @property
    def count(self) -> float:
        """How many cells such a pack has."""
        return self.pack_wh / (self.cell_ah * self.cell_v)


@dataclass(frozen=True, slots=True)
class BlendedCar:
    """A power-split hybrid of the size of a Toyota Prius that blends fuel with a large battery.

    The report names its car and the size of its pack and refers to another paper for the rest, an optimal policy of
    stochastic dynamic programming. Here a plain policy stands for it: the engine follows a share of the power asked
    for, slowly, and the battery gives and takes what is left.

    Attributes
    ----------
    mass_kg : float
        A Prius of 1380 kg, 145 kg for the larger pack, and a driver.
    rotating_share : float
        Of the mass, for wheels and machines that turn.
    drag_area_m2, rolling : float
        C_d · A of 0.26 · 2.23 m², and tyres of low resistance.
    auxiliary_w : float
        Electricity of everything that doesn't drive.
    drive_efficiency : float
        From the battery to the wheels: inverter, motor and gears.
    recovery : float
        Share of the braking power that comes back to the battery; the rest is losses and the rear brakes.
    recovery_w : float
        The most the battery takes back.
    recovery_mps : float
        Below this speed the brakes alone hold.
    engine_share : float
        Of the power at the wheels, chosen so that the battery goes from 80 % to 20 % in nearly three hours, as fig. 28
        shows it.
    engine_s : float
        Time constant with which the engine follows.
    air_kgpm3 : float
    cells : Cells
    """

    mass_kg: float = 1600.0
    rotating_share: float = 0.04
    drag_area_m2: float = 0.58
    rolling: float = 0.008
    auxiliary_w: float = 600.0
    drive_efficiency: float = 0.82
    recovery: float = 0.68
    recovery_w: float = 30_000.0
    recovery_mps: float = 3.0
    engine_share: float = 0.15
    engine_s: float = 60.0
    air_kgpm3: float = 1.2
    cells: Cells = Cells()


def cell_current(car: BlendedCar, t_s: FloatArray, speed_mps: FloatArray) -> FloatArray:
    """Return the current of one cell over a driving cycle on level road.

    Parameters
    ----------
    car : BlendedCar
    t_s, speed_mps : ndarray (n,)
        The cycle; speeds between its times are on a straight line.

    Returns
    -------
    ndarray (m,)
        Amperes in each second from the cycle's first to its last; charging is positive.
    """
    seconds = np.arange(t_s[0], t_s[-1] + 0.5 * STEP_S, STEP_S)
    speed = np.interp(seconds, t_s, speed_mps)
    wheels_w = wheel_power(car, speed)
    engine_w = car.engine_share * _slowly(np.maximum(wheels_w, 0.0), car.engine_s)
    asked_w = np.where(wheels_w > 0.0, wheels_w - engine_w, -engine_w)
    battery_w = car.auxiliary_w + np.where(
        asked_w > 0.0, asked_w / car.drive_efficiency, asked_w * car.drive_efficiency
    )
    mean_speed = 0.5 * (speed[1:] + speed[:-1])
    braking_w = np.where(mean_speed > car.recovery_mps, np.minimum(wheels_w, 0.0) * car.recovery, 0.0)
    return current_of(car.cells, battery_w + np.maximum(braking_w, -car.recovery_w))


def wheel_power(car: BlendedCar, speed_mps: FloatArray) -> FloatArray:
    """Return the mean power at the wheels in each second between (n,) speeds, watts, (n − 1,)."""
    mean, gained = 0.5 * (speed_mps[1:] + speed_mps[:-1]), np.diff(speed_mps) / STEP_S
    rolling_n = car.mass_kg * GRAVITY_MPS2 * car.rolling
    drag_n = 0.5 * car.air_kgpm3 * car.drag_area_m2 * mean**2
    inertia_n = car.mass_kg * (1.0 + car.rotating_share) * gained
    return np.asarray((rolling_n + drag_n + inertia_n) * mean)


def current_of(cells: Cells, battery_w: FloatArray) -> FloatArray:
    """Return the current of one cell, amperes, that gives the pack's terminals a power, watts; charging is positive."""
    given_w = -battery_w / cells.count
    inside = np.maximum(cells.cell_v**2 + 4.0 * cells.resistance_ohm * given_w, 0.0)
    return np.asarray((np.sqrt(inside) - cells.cell_v) / (2.0 * cells.resistance_ohm))


def _slowly(asked: FloatArray, time_constant_s: float) -> FloatArray:
    followed, kept, state = np.empty_like(asked), np.exp(-STEP_S / time_constant_s), 0.0
    for k, value in enumerate(asked):
        state = value + (state - value) * kept
        followed[k] = state
    return followed
