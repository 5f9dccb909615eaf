"""All of a cell's parameters from a whole record at once: the offline judge of the recursive estimators.

Maximum a posteriori by Gauss-Newton with Levenberg's damping on the exact simulated voltage, with the report's error
criterion (MAUTC-2010-02, eq. 57) in the place of its recursive gradient.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH, Circuit
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.identify_descent import Problem, Solution, solve
from app.science.battery.pack import cell_record
from app.science.battery.preparing import prepare
from app.science.battery.record import BatteryRecord
from app.science.battery.run import Carry

OPEN_SD = 1.0
"""Standard deviation of a parameter's logarithm that nobody said anything about."""

STARTS_S = (5.0, 30.0, 200.0, 1500.0)
"""Time constants of the relaxation from which the search sets out beside the configured one."""

UNCERTAIN = 0.1
"""Share of a parameter's value from which its standard deviation is worth a warning."""

COLOURED = 20.0
"""Rows over which residuals hang together from which the circuit is said to be too simple for the cell."""


@dataclass(frozen=True, slots=True)
class Identified:
    """What a record says as a whole about a cell.

    Attributes
    ----------
    values, sds : ndarray (5,)
        In the order of `VALUES`; ``soc`` is the one at the first row.
    bias_a, bias_sd_a : float
        Constant error of the current sensor, one cell's share.
    residual_v : ndarray (n,)
        Measured less simulated voltage; NaN where there is none.
    voltage_rms_v : float
        Root mean square of the residuals.
    rows_together : float
        Rows over which residuals hang together: 1 for white noise. Standard deviations count so many rows as one.
    converged : bool
    carry : Carry
        What is known at the last row.
    warnings : tuple of str
    """

    values: FloatArray
    sds: FloatArray
    bias_a: float
    bias_sd_a: float
    residual_v: FloatArray
    voltage_rms_v: float
    rows_together: float
    converged: bool
    carry: Carry
    warnings: tuple[str, ...]

    @property
    def circuit(self) -> Circuit:
        """The four parameters."""
        return Circuit(*(float(value) for value in self.values[:4]))

    def document(self) -> dict[str, Any]:
        """Return the answer with the names that estimates have."""
        named = {name: float(value) for name, value in zip(VALUES, self.values, strict=True)}
        named |= {f"{name}_sd": float(sd) for name, sd in zip(VALUES, self.sds, strict=True)}
        return named | {
            "current_bias_a": self.bias_a,
            "current_bias_a_sd": self.bias_sd_a,
            "time_constant_s": self.circuit.time_constant_s,
            "voltage_rms_v": self.voltage_rms_v,
            "rows_together": self.rows_together,
            "converged": self.converged,
            "warnings": list(self.warnings),
        }


def identify(
    record: BatteryRecord, config: BatteryConfig, carry: Carry | None = None, curve_sd_v: float = 0.0
) -> Identified:
    """Find capacity, resistances, relaxation, first state of charge and current bias that explain a record best.

    Parameters
    ----------
    record : BatteryRecord
        Of the pack.
    config : BatteryConfig
        Its cell is where the search sets out; ``initial_sd`` says how sure that is. What it does not name is nearly
        free.
    carry : Carry, optional
        What was known before, in the place of the configuration's cell.
    curve_sd_v : float
        By how much the open-circuit curve may be off, smoothly along the charge; it widens the standard deviations and
        leaves the values.

    Raises
    ------
    TooLittleData
        When hardly a row has a voltage.
    """
    prepared = prepare(record, config, carry)
    record, config = prepared.record, prepared.config
    prior = carry or _prior(config, float(record.t_s[0]))
    problem = Problem.of(cell_record(record, config), config.cell.curve.pieces, prior, curve_sd_v)
    best = solve(problem, _starts(prior, carry))
    return _identified(record, problem, best)


def _prior(config: BatteryConfig, t_s: float) -> Carry:
    cell, sd = config.cell, config.initial_sd
    circuit = cell.circuit
    parameters = (circuit.capacity_as, circuit.resistance_ohm, circuit.relaxation_capacitance_f)
    mean = np.array([*np.log([*parameters, circuit.relaxation_resistance_ohm]), cell.soc, 0.0, 0.0])
    sds = [sd.get(name, OPEN_SD) for name in VALUES[:4]]
    relaxed_v = circuit.relaxation_resistance_ohm * circuit.capacity_ah
    sds += [sd.get("soc", 0.3), relaxed_v, max(config.current_bias_a, 1e-6)]
    return Carry(mean, np.diag(np.square(sds)), t_s)


def _starts(prior: Carry, carry: Carry | None) -> list[FloatArray]:
    """Return where to set out from: as given, and with other time constants of the same relaxation resistance."""
    if carry is not None:
        return [prior.mean]
    starts = [prior.mean]
    for time_constant_s in STARTS_S:
        start = prior.mean.copy()
        start[2] = np.log(time_constant_s) - start[3]
        starts.append(start)
    return starts


def _identified(record: BatteryRecord, problem: Problem, found: Solution) -> Identified:
    values = found.unknowns[:5].copy()
    values[:4] = np.exp(values[:4])
    deviations = np.sqrt(np.diag(found.covariance))
    sds = deviations[:5] * np.append(values[:4], 1.0)
    values[0], sds[0] = values[0] / AS_PER_AH, sds[0] / AS_PER_AH
    return Identified(
        values=values,
        sds=sds,
        bias_a=float(found.unknowns[6]),
        bias_sd_a=float(deviations[6]),
        residual_v=found.residual_v,
        voltage_rms_v=float(np.sqrt(np.nanmean(found.residual_v**2))),
        rows_together=found.rows_together,
        converged=found.converged,
        carry=Carry(found.last_mean, found.last_covariance, float(record.t_s[-1])),
        warnings=(*record.warnings, *_doubts(problem, found)),
    )


def _doubts(problem: Problem, found: Solution) -> list[str]:
    said = []
    before, after = np.sqrt(np.diag(problem.covariance)), np.sqrt(np.diag(found.covariance))
    for k, name in enumerate(WORDS):
        if after[k] > UNCERTAIN or after[k] > 0.7 * before[k]:
            said.append(f"The data say little about the {name}: ± {min(after[k], 9.99):.0%} remain.")
    if found.rows_together > COLOURED:
        rms_mv = 1e3 * np.sqrt(np.nanmean(found.residual_v**2))
        said.append(
            f"What remains of the voltage, {rms_mv:.2g} mV rms, hangs together over {found.rows_together:.0f} rows: "
            "the circuit or the open-circuit curve is too simple for this cell. The standard deviations allow for it "
            "roughly; values that the misfit pulls on may be further off."
        )
    if not found.converged:
        said.append("The search did not settle; begin nearer, or give less of the record.")
    return said


WORDS = ("capacity", "resistance", "relaxation's capacitance", "relaxation's resistance")
