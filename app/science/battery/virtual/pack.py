"""A battery with known truth: driven and charged for days, and measured by sensors with known errors."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH, Cell
from app.science.battery.curve import voltage_at
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import cell_numbers
from app.science.battery.virtual.a123 import CELL, CURRENT_NOISE_A, SECONDS_PER_DAY, VOLTAGE_NOISE_V
from app.science.battery.virtual.ageing import DegradationMap
from app.science.battery.virtual.current import STEP_S, BlendedCar, Cells, cell_current
from app.science.battery.virtual.cycling_kernels import LossTable, Routine, cycle_cell
from app.science.battery.virtual.ftp72 import ftp_72
from app.science.errors import ScienceError


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
        The truth, its state of charge at the first row, and how many there are. It stays at the temperature at which
        its values hold.
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


@dataclass(frozen=True, slots=True)
class VirtualData:
    """What was measured, and what was so.

    Attributes
    ----------
    record : BatteryRecord
        Of the pack, as its sensors tell it.
    soc : ndarray (n,)
    capacity_ah : ndarray (n,)
        Of one cell.
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
    current, voltage, soc, capacity = cycle_cell(
        pack.cell.curve.pieces, cell_numbers(pack.cell), routine, _table(pack.fade), pack.cell.soc, rows
    )
    capacity /= AS_PER_AH
    return VirtualData(_measured(pack, current, voltage), soc, capacity, current, pack.cell)


def _measured(pack: VirtualPack, current_a: FloatArray, voltage_v: FloatArray) -> BatteryRecord:
    rng = np.random.default_rng(pack.seed)
    n = len(current_a)
    current = _rounded(
        pack.cell.parallel * current_a + pack.current_bias_a + pack.current_noise_a * rng.standard_normal(n),
        pack.current_step_a,
    )
    voltage = _rounded(
        pack.cell.series * voltage_v + pack.voltage_noise_v * rng.standard_normal(n), pack.voltage_step_v
    )
    return BatteryRecord(STEP_S * np.arange(n, dtype=np.float64), current, voltage)


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
    if drive_a.mean() >= 0.0:
        raise ScienceError(
            f"The drive leaves the battery {drive_a.mean():.3f} A fuller on average, so it never comes down to "
            f"{lowest:.0%}; take a drive with more to do, or an engine with a smaller share."
        )
    if pack.charge_a <= 0.0:
        raise ScienceError(f"A charging current of {pack.charge_a:g} A charges nothing; it has to be positive.")
