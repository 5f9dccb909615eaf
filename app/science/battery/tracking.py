"""Capacity from discharge to discharge of a cell that is charged full between them and seldom emptied.

A full discharge measures the capacity outright and shows the curve as it is now. Partial ones in between are estimated
with that curve and with what was carried over. The curve is fitted with the circuit's resistances taken off, so that it
explains the last full discharge exactly: what a cell's ageing does beyond capacity and resistance starts from nothing
with each of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.battery.capacity_test import capacity_tests
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.estimate import estimate
from app.science.battery.kalman.belief import possible
from app.science.battery.open_circuit_fit import fit_curve
from app.science.battery.record import BatteryRecord
from app.science.battery.run import Carry
from app.science.errors import TooLittleData

SAMPLES = 4001

OPPOSITE = 0.999
"""Correlation with which C_r falls as R_r grows when the time constant is kept; a little below one can be inverted."""


@dataclass(frozen=True, slots=True)
class Tracking:
    """How discharges are followed.

    Attributes
    ----------
    circuit : Circuit
        What is taken off the voltage when a curve is fitted; its capacity does not count.
    limits_v : tuple of float
        Voltages of one cell that are empty and full.
    first : int
        Records at the beginning that are taken together for the first curve; they must be full discharges.
    walk : tuple of float
        By how much ln Q, ln R, ln C_r and ln R_r may change from one record to the next, standard deviations.
    keeps_time_constant : bool
        The walk leaves R_r C_r where it is: resistance grows and the time of the relaxation stays. Better where full
        discharges are rare, because nothing then stops both from wandering off together.
    known : tuple of float
        How sure they are after a full discharge.
    full_sd, rest_v, bias_a : float
        How sure the state of charge is after charging, the relaxation voltage after resting, and the current sensor.
    """

    circuit: Circuit
    limits_v: tuple[float, float]
    first: int = 3
    walk: tuple[float, float, float, float] = (0.01, 0.02, 0.02, 0.02)
    keeps_time_constant: bool = False
    known: tuple[float, float, float, float] = (0.002, 0.02, 0.02, 0.02)
    full_sd: float = 0.002
    rest_v: float = 0.001
    bias_a: float = 0.001


@dataclass(frozen=True, slots=True)
class Tracked:
    """What one discharge says.

    Attributes
    ----------
    capacity_ah, sd_ah : float
        Down to the empty voltage, at the discharge's own current.
    measured : bool
        Counted in a full discharge, not estimated.
    circuit : Circuit
        As estimated; of a measured one, what the curve was fitted with.
    """

    capacity_ah: float
    sd_ah: float
    measured: bool
    circuit: Circuit


def track(records: Sequence[BatteryRecord], tracking: Tracking) -> Iterator[Tracked]:
    """Follow a cell's capacity; each record begins full and at rest, and nothing looks ahead.

    Parameters
    ----------
    records : sequence of BatteryRecord
        Of one cell, one for each discharge, in order.
    tracking : Tracking

    Raises
    ------
    TooLittleData
        When one of the first records is no full discharge.
    """
    config: BatteryConfig | None = None
    carry: Carry | None = None
    for k, record in enumerate(records):
        tests = capacity_tests(record, tracking.limits_v)
        if tests or carry is None or config is None:
            if not tests:
                raise TooLittleData(
                    f"Discharge {k + 1} does not reach {tracking.limits_v[0]:.3f} V from full; the first curve needs "
                    "full discharges."
                )
            taken = records[: k + 1] if k < tracking.first else [record]
            config, carry = _begun(taken, tracking)
            yield Tracked(tests[-1].capacity_ah, tests[-1].sd_ah, True, config.cell.circuit)
        else:
            found = estimate(record, config, _charged(carry, tracking, float(record.t_s[0])))
            carry = found.carry
            circuit = Circuit(*(float(value) for value in found.values[:4]))
            current = float(np.median(-record.current_a[record.current_a < 0.0]))
            usable = usable_ah(config.cell.curve, circuit, current, tracking.limits_v[0])
            yield Tracked(usable, usable * float(found.sds[0] / found.values[0]), False, circuit)


def usable_ah(curve: OpenCircuit, circuit: Circuit, current_a: float, lower_v: float) -> float:
    """Return what a full cell gives at a constant current until its voltage passes the lower one, ampere-hours."""
    soc = np.linspace(1.0, curve.soc_range[0], SAMPLES)
    lasted_s = (1.0 - soc) * circuit.capacity_as / current_a
    relaxed = circuit.relaxation_resistance_ohm * (1.0 - np.exp(-lasted_s / circuit.time_constant_s))
    volts = voltage_at(curve.pieces, soc) - current_a * (circuit.resistance_ohm + relaxed)
    below = np.flatnonzero(volts <= lower_v)
    return circuit.capacity_ah * float(1.0 - (soc[below[0]] if len(below) else soc[-1]))


def _begun(records: Sequence[BatteryRecord], tracking: Tracking) -> tuple[BatteryConfig, Carry]:
    """Return the cell as full discharges show it."""
    fitted = fit_curve(records, limits_v=tracking.limits_v, circuit=tracking.circuit)
    circuit = replace(tracking.circuit, capacity_ah=fitted.capacity_ah)
    logarithms = np.log([circuit.capacity_as, circuit.resistance_ohm, circuit.relaxation_capacitance_f])
    mean = np.array([*logarithms, np.log(circuit.relaxation_resistance_ohm), 1.0, 0.0, 0.0])
    known = np.diag(np.square([*tracking.known, tracking.full_sd, tracking.rest_v, tracking.bias_a]))
    return BatteryConfig(Cell(fitted.curve, circuit, 1.0)), Carry(mean, known, 0.0)


def _charged(carry: Carry, tracking: Tracking, t_s: float) -> Carry:
    """Return what is known after charging: full, at rest, and the parameters a little changed."""
    walk = np.diag(np.square(tracking.walk))
    if tracking.keeps_time_constant:
        walk[2, 3] = walk[3, 2] = -OPPOSITE * tracking.walk[2] * tracking.walk[3]
    sds = (0.0, 0.0, 0.0, 0.0, tracking.full_sd, tracking.rest_v, tracking.bias_a)
    covariance = np.diag(np.square(sds))
    covariance[:4, :4] = possible(carry.covariance)[:4, :4] + walk
    return Carry(np.array([*carry.mean[:4], 1.0, 0.0, 0.0]), covariance, t_s)
