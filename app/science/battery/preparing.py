"""What is done to a record and a configuration before an estimator sees them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from app.science.battery.config import BatteryConfig
from app.science.battery.curve import soc_at
from app.science.battery.faults import screened, without_spikes
from app.science.battery.plausible import with_plausible_charge, with_plausible_voltage
from app.science.battery.record import BatteryRecord
from app.science.battery.response import Response, response_of
from app.science.battery.run import Carry
from app.science.battery.sign import counted_rightly
from app.science.battery.words import counted
from app.science.errors import TooLittleData

LEAST_ROWS = 10
CLEARLY, FAR_TIMES = 10.0, 4.0
"""Standard deviations of a resistance seen at steps, and how many times the configured one must differ from it."""
LOOKED_UP_SD = 0.15
"""Of a state of charge that was read from a first voltage, where the battery did not rest before."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """What an estimator is given.

    Attributes
    ----------
    record : BatteryRecord
        Without what can't be believed; its warnings say what was done.
    config : BatteryConfig
        Its state of charge is known.
    response : Response
        How the voltage answers the current.
    unknown_from_s : tuple of float
        Times of rows after which the current is not known, because its sensor was stuck.
    """

    record: BatteryRecord
    config: BatteryConfig
    response: Response
    unknown_from_s: tuple[float, ...] = ()


def prepare(record: BatteryRecord, config: BatteryConfig, carry: Carry | None) -> Prepared:
    """Return what an estimator is given: the current's sign right, units looked at, stuck sensors taken out.

    Raises
    ------
    TooLittleData
        When hardly a row has a voltage.
    SignalsError
        When the record can't be of this battery, or a sensor was stuck nearly all the time.
    """
    _refuse_little(record)
    response = response_of(record)
    counted_right = counted_rightly(record, config, response)
    response = replace(response, ohm=-response.ohm) if counted_right.turned else response
    record = with_plausible_voltage(without_spikes(counted_right.record, config, response), config, response)
    found = screened(record, config, response)
    record = with_plausible_charge(found.record, config, found.unknown_from_s)
    _refuse_little(record)
    record, config = _with_seen_resistance(record, config, response, carry)
    record, config = _with_first_soc(record, config, carry)
    return Prepared(record, config, response, found.unknown_from_s)


def _refuse_little(record: BatteryRecord) -> None:
    known = int(np.isfinite(record.voltage_v).sum())
    if known < LEAST_ROWS:
        raise TooLittleData(
            f"{counted(known, 'row')} with a voltage that can be believed {'is' if known == 1 else 'are'} left of "
            f"{len(record.t_s)}; {LEAST_ROWS} are needed at least."
        )


def _with_seen_resistance(
    record: BatteryRecord, config: BatteryConfig, response: Response, carry: Carry | None
) -> tuple[BatteryRecord, BatteryConfig]:
    """Begin with the resistance that steps of the current show, where it is far from the configured one."""
    cell = config.cell
    thought, seen = cell.circuit.resistance_ohm, response.ohm * cell.parallel / cell.series
    clear = response.sharp and response.certainty > CLEARLY and response.explained > 0.5 and response.lag == 0
    if carry is not None or not clear or thought / FAR_TIMES < seen < thought * FAR_TIMES:
        return record, config
    said = (
        f"At steps of the current the voltage of one cell answers with {1e3 * seen:.3g} mΩ; the configuration's "
        f"resistance is {1e3 * thought:.3g} mΩ. The estimate began with the former."
    )
    circuit = replace(cell.circuit, resistance_ohm=seen)
    return (
        replace(record, warnings=(*record.warnings, said)),
        replace(config, cell=replace(cell, circuit=circuit)),
    )


def _with_first_soc(
    record: BatteryRecord, config: BatteryConfig, carry: Carry | None
) -> tuple[BatteryRecord, BatteryConfig]:
    """Look the first state of charge up from the first voltage, less what the current does to it."""
    cell = config.cell
    if isfinite(cell.soc):
        return record, config
    if carry is not None:
        return record, replace(config, cell=replace(cell, soc=float(carry.mean[4])))
    first = int(np.flatnonzero(np.isfinite(record.voltage_v))[0])
    amps = record.current_a[first] / cell.parallel
    volts = record.voltage_v[first] / cell.series - cell.circuit.resistance_ohm * amps
    soc = float(soc_at(cell.curve, np.array([volts]))[0])
    sds = {"soc": LOOKED_UP_SD} | dict(config.initial_sd)
    said = (
        f"The configuration says no state of charge to begin with; {soc:.0%} is read from the first voltage, "
        f"{volts:.3f} V of one cell, ± {sds['soc']:.0%}."
    )
    return (
        replace(record, warnings=(*record.warnings, said)),
        replace(config, cell=replace(cell, soc=soc), initial_sd=sds),
    )
