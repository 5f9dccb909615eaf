"""A battery with known truth: driven and charged for days, and measured by sensors with known errors."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH, Cell
from app.science.battery.curve import voltage_at
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import cell_numbers, row_factors
from app.science.battery.virtual.a123 import CELL, CURRENT_NOISE_A, SECONDS_PER_DAY, VOLTAGE_NOISE_V
from app.science.battery.virtual.ageing import DegradationMap
from app.science.battery.virtual.current import STEP_S, BlendedCar, Cells, cell_current
from app.science.battery.virtual.cycling_kernels import LossTable, Routine, cycle_cell
from app.science.battery.virtual.ftp72 import ftp_72
from app.science.errors import ScienceError

HOTTEST_C = 80.0


@dataclass(frozen=True, slots=True)
class VirtualPack:
    """What is simulated: MAUTC-2010-02, part 3, 4.2 and 4.3, unless told otherwise.

    Attributes
    ----------
    days : float
        Length, one row a second.
    seed : int
        Of the sensors' noise.
    cell : Cell
        The truth, its state of charge at the first row, and how many there are.
    car : BlendedCar
        Whose drives empty it.
    charge_a : float
        One cell's current while charging.
    soc_range : tuple of float
        States of charge at which charging begins, and ends.
    current_noise_a, voltage_noise_v : float
        Standard deviations of the pack's sensors.
    current_bias_a : float
        What the current's sensor shows too much, always.
    current_step_a, voltage_step_v : float
        What the sensors round to; 0: they don't.
    fade : DegradationMap or None
        How the capacity shrinks; None: never.
    temperature_c : tuple of float or None
        Mean of a day, and how far it rises and falls about that; None: always that at which the cell's values hold, and
        nobody measures it.
    """

    days: float
    seed: int = 1
    cell: Cell = CELL
    car: BlendedCar = field(default_factory=BlendedCar)
    charge_a: float = 2.0
    soc_range: tuple[float, float] = (0.2, 0.8)
    current_noise_a: float = CURRENT_NOISE_A
    voltage_noise_v: float = VOLTAGE_NOISE_V
    current_bias_a: float = 0.0
    current_step_a: float = 0.0
    voltage_step_v: float = 0.0
    fade: DegradationMap | None = None
    temperature_c: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class VirtualData:
    """What was measured, and what was so.

    Attributes
    ----------
    record : BatteryRecord
        Of the pack, as its sensors tell it.
    soc : ndarray (n,)
    capacity_ah : ndarray (n,)
        Of one cell, at its reference temperature.
    current_a : ndarray (n,)
        Of one cell, without the sensors' errors.
    cell : Cell
        As it was at the first row.
    """

    record: BatteryRecord
    soc: FloatArray
    capacity_ah: FloatArray
    current_a: FloatArray
    cell: Cell


def pack_of(cell: Cell, days: float) -> VirtualPack:
    """Return another cell in the place of the report's: the car's pack is made of such, and they charge at 1 C."""
    circuit = cell.circuit
    cells = Cells(
        cell_ah=circuit.capacity_ah,
        cell_v=float(voltage_at(cell.curve.pieces, np.array([0.5]))[0]),
        resistance_ohm=circuit.resistance_ohm + circuit.relaxation_resistance_ohm,
    )
    return VirtualPack(days, cell=cell, car=BlendedCar(cells=cells), charge_a=circuit.capacity_ah)


def virtual_pack(pack: VirtualPack, drive_cycle: tuple[FloatArray, FloatArray] | None = None) -> VirtualData:
    """Drive a pack down and charge it up for days.

    The drive is repeated until the lower state of charge is reached, which may be in its middle; then the cell is
    charged up to the higher one, and the drive begins anew.

    Parameters
    ----------
    pack : VirtualPack
    drive_cycle : tuple of ndarray (m,)
        Time, seconds, and speed, m/s; None: FTP-72.

    Returns
    -------
    VirtualData

    Raises
    ------
    ScienceError
        When the drive doesn't empty the battery, or the states of charge are not in order.
    """
    drive_a = cell_current(pack.car, *(drive_cycle or ftp_72()))
    routine = Routine(drive_a, pack.charge_a, *pack.soc_range, STEP_S)
    _check(pack, drive_a)
    rows = int(np.floor(pack.days * SECONDS_PER_DAY / STEP_S)) + 1
    t_s = STEP_S * np.arange(rows, dtype=np.float64)
    warm = _temperature(pack, t_s)
    factors = row_factors(pack.cell.warmth, warm)
    curve, losses = pack.cell.curve.pieces, _table(pack.fade)
    current, voltage, soc, capacity = cycle_cell(
        curve, cell_numbers(pack.cell), factors, routine, losses, pack.cell.soc, rows
    )
    capacity /= AS_PER_AH
    measured = BatteryRecord(t_s, *_measured(pack, current, voltage), warm)
    return VirtualData(measured, soc, capacity, current, pack.cell)


def _temperature(pack: VirtualPack, t_s: FloatArray) -> FloatArray | None:
    """Return days that begin at their mean and are warmest six hours later, °C."""
    if pack.temperature_c is None:
        return None
    mean, swing = pack.temperature_c
    return np.asarray(mean + swing * np.sin(2.0 * np.pi * t_s / SECONDS_PER_DAY))


def _measured(pack: VirtualPack, current_a: FloatArray, voltage_v: FloatArray) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(pack.seed)
    n = len(current_a)
    current = _rounded(
        pack.cell.parallel * current_a + pack.current_bias_a + pack.current_noise_a * rng.standard_normal(n),
        pack.current_step_a,
    )
    voltage = _rounded(
        pack.cell.series * voltage_v + pack.voltage_noise_v * rng.standard_normal(n), pack.voltage_step_v
    )
    return current, voltage


def _rounded(values: FloatArray, step: float) -> FloatArray:
    return np.asarray(np.round(values / step) * step, dtype=np.float64) if step > 0.0 else values


def _table(fade: DegradationMap | None) -> LossTable:
    if fade is None:
        return LossTable(np.zeros(0), False, np.zeros(0), np.zeros((0, 0)))
    return LossTable(np.array(fade.current_a), fade.axis == "soc", np.array(fade.at), np.array(fade.loss_ah_per_ah))


def _check(pack: VirtualPack, drive_a: FloatArray) -> None:
    lowest, highest = pack.soc_range
    if not lowest < highest:
        raise ScienceError(f"The lowest state of charge, {lowest:g}, is not below the highest, {highest:g}.")
    mean, swing = pack.temperature_c or (0.0, 0.0)
    if abs(mean) + abs(swing) > HOTTEST_C:
        raise ScienceError(f"{mean:g} ± {swing:g} °C leads beyond ±{HOTTEST_C:g} °C, where no such cell lives.")
    if drive_a.mean() >= 0.0:
        raise ScienceError(
            f"The drive leaves the battery {drive_a.mean():.3f} A fuller on average, so it never comes down to "
            f"{lowest:.0%}; take a drive with more to do, or an engine with a smaller share."
        )
    if pack.charge_a <= 0.0:
        raise ScienceError(f"A charging current of {pack.charge_a:g} A charges nothing; it has to be positive.")
