"""Why an estimate is not to be believed as it stands, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.beginning import LOST
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.kalman.belief import INITIAL_SD
from app.science.battery.record import BatteryRecord
from app.science.battery.response import Response, quantum
from app.science.battery.run import Carry, Run
from app.science.battery.words import listed
from app.science.errors import EstimatorDiverged

POORLY_KNOWN = 0.1
"""Relative standard deviation from which on a parameter is said to be hardly known."""
AS_BEFORE = 0.7
"""Share of the deviation to begin with that must be left for the data to have said nothing."""
KNOWN_BEFORE = 0.03
UNSURE_SOC = 0.05
TIMES_NOISE, LEAST_V = 2.0, 0.001
"""A residual is the model's when it is so many times the voltage's own noise, and more than so much beyond it."""
LINGERING = 0.5
UNBELIEVED = 0.05
OVER = 0.02
OFF = 0.5
FAR_OFF = 4.0
"""Times by which a parameter may differ from what was thought."""
BIASES = 3.0

NAMED = {
    "capacity_ah": "the capacity",
    "resistance_ohm": "the series resistance",
    "relaxation_capacitance_f": "the relaxation's capacitance",
    "relaxation_resistance_ohm": "the relaxation's resistance",
}
REMEDY = {
    "capacity_ah": "a charge or discharge over a good part of the capacity",
    "resistance_ohm": "a current that changes in steps",
    "relaxation_capacitance_f": "currents that change and last for some time constants, and rests",
    "relaxation_resistance_ohm": "currents that change and last for some time constants, and rests",
}


def refuse_what_is_lost(record: BatteryRecord, config: BatteryConfig, run: Run) -> None:
    """Refuse numbers that are none, and capacities that can't be.

    Raises
    ------
    EstimatorDiverged
        With the time at which it was noticed.
    """
    times = run.values[:, 0] / config.cell.circuit.capacity_ah
    with np.errstate(invalid="ignore"):  # what is no number is lost anyway
        lost = ~np.isfinite(run.values).all(axis=1) | (times > LOST) | (times < 1.0 / LOST)
    if lost[-1]:
        share = float(np.flatnonzero(lost)[0]) / len(lost)
        t_s = float(record.t_s[0] + share * (record.t_s[-1] - record.t_s[0]))
        raise EstimatorDiverged(
            f"The estimator ran away near {t_s:.0f} s: its capacity of one cell went to {run.values[-1, 0]:.3g} Ah. "
            "Look at the data there; give initial values, series and parallel that are nearer to the truth.",
            t_s,
        )


def doubts(
    record: BatteryRecord, config: BatteryConfig, response: Response, run: Run, carry: Carry | None, rms_v: float
) -> tuple[str, ...]:
    """Return what speaks against believing an estimate, most of it with what would help."""
    if not run.learnt.any():
        return (_nothing_learnt(record, config),)
    return (
        *_together(record, response),
        *_curve(config),
        *_excitation(run, config, carry),
        *_charge(config, run),
        *_parameters(config, run),
        *_residuals(record, config, response, run, rms_v),
    )


def own_noise(record: BatteryRecord, config: BatteryConfig, response: Response) -> float:
    """Return the noise of one cell's voltage as it shows from row to row, without the model, volts."""
    noise_v = float(max(response.noise_v, quantum(record.voltage_v) / np.sqrt(12.0)) / config.cell.series)
    return max(noise_v, config.voltage_noise_v or 0.0)


def _nothing_learnt(record: BatteryRecord, config: BatteryConfig) -> str:
    lasting = float(record.t_s[-1] - record.t_s[0])
    if config.start_after_s > lasting:
        return (
            f"The estimator was to start after {config.start_after_s:g} s, and the record lasts {lasting:g} s: nothing "
            "was learnt from it, everything is as it was given."
        )
    return "No voltage was believed: nothing was learnt from the record, everything is as it was given."


def _together(record: BatteryRecord, response: Response) -> Iterator[str]:
    if response.lag and abs(response.certainty) > 6.0 and response.explained > 0.5:
        rows = "1 row" if abs(response.lag) == 1 else f"{abs(response.lag)} rows"
        later = "later" if response.lag > 0 else "earlier"
        yield (
            f"The voltage answers the current {rows} {later} than the row it stands in: R, C_r and R_r are off by some "
            "percent. A row's voltage should be of its own time, with the current that flows from then on."
        )


def _curve(config: BatteryConfig) -> Iterator[str]:
    curve = config.cell.curve
    falling = curve.falls()
    if falling is not None:
        yield (
            f"The open-circuit curve falls between {falling[0]:.1%} and {falling[1]:.1%} of the charge: there, and "
            "where it has the same voltages, the state of charge can't be told."
        )


def _excitation(run: Run, config: BatteryConfig, carry: Carry | None) -> Iterator[str]:
    before = _before(config, carry)
    relative = run.sds[-1, :4] / run.values[-1, :4]
    dark = (relative > POORLY_KNOWN) | ((relative > AS_BEFORE * before) & (relative > KNOWN_BEFORE))
    if dark.any():
        names = [name for name, is_dark in zip(VALUES, dark, strict=False) if is_dark]
        said = [f"{NAMED[name]} (± {share:.0%})" for name, share in zip(names, relative[dark], strict=True)]
        yield _dark(config, said, list(dict.fromkeys(REMEDY[name] for name in names)))
    if run.sds[-1, 4] > UNSURE_SOC:
        yield (
            f"The state of charge is known to ± {run.sds[-1, 4]:.0%} only: where the open-circuit curve is flat, the "
            "voltage hardly tells it."
        )


def _dark(config: BatteryConfig, said: list[str], remedies: list[str]) -> str:
    if config.estimator == "gpc":
        return (
            f"The gradient estimator has not settled on {listed(said)}: it moves slowly. It takes a longer record, or "
            "another estimator, such as ekf_bias."
        )
    little = f"The data say little of {listed(said)}: what is told is mostly what was configured."
    return f"{little} It takes {listed(remedies)}."


def _before(config: BatteryConfig, carry: Carry | None) -> FloatArray:
    """Return the relative standard deviations of the four parameters to begin with."""
    if carry is not None:
        return np.sqrt(np.diag(carry.covariance)[:4])
    return np.array([config.initial_sd.get(name, INITIAL_SD[name]) for name in VALUES[:4]])


def _charge(config: BatteryConfig, run: Run) -> Iterator[str]:
    learnt = run.values[len(run.values) // 2 :, 4]
    low, high = float(learnt.min()), float(learnt.max())
    if low < -OVER or high > 1.0 + OVER:
        yield (
            f"The state of charge goes from {low:.0%} to {high:.0%}, which can't be: the open-circuit curve, the cells "
            "in series or the current do not fit this battery."
        )
        return
    known = config.cell.curve.soc_range
    if low < known[0] - OVER or high > known[1] + OVER:
        yield (
            f"The state of charge goes from {low:.0%} to {high:.0%}; the open-circuit curve is known from "
            f"{known[0]:.0%} to {known[1]:.0%} and goes on as a straight line beyond."
        )


def _parameters(config: BatteryConfig, run: Run) -> Iterator[str]:
    circuit, found = config.cell.circuit, run.values[-1]
    times = found[0] / circuit.capacity_ah
    if abs(times - 1.0) > OFF:
        yield (
            f"The capacity came out as {found[0]:.4g} Ah of one cell, {times:.2g} times what was configured: is "
            "parallel right, and the current's unit?"
        )
    rated = config.rated_capacity_ah
    if rated is not None and found[0] > 1.15 * rated + 2.0 * run.sds[-1, 0]:
        yield f"The capacity is {found[0] / rated:.0%} of the rated one, {rated:g} Ah: is that rated of one cell?"
    for k, name in enumerate(VALUES[1:4], start=1):
        thought = getattr(circuit, name)
        if not thought / FAR_OFF < found[k] < thought * FAR_OFF and run.sds[-1, k] < POORLY_KNOWN * found[k]:
            yield f"{NAMED[name].capitalize()} came out {found[k] / thought:.3g} times as large as configured."
    if abs(run.bias_a[-1]) > BIASES * config.current_bias_a > 0.0:
        yield (
            f"The current's sensor seems to be off by {run.bias_a[-1]:.3g} A of one cell, far more than the "
            f"{config.current_bias_a:.3g} A it was thought to be (current_bias_a): calibrate it at rest."
        )


def _residuals(
    record: BatteryRecord, config: BatteryConfig, response: Response, run: Run, rms_v: float
) -> Iterator[str]:
    had_voltage = np.isfinite(run.residual_v) & (record.t_s >= record.t_s[0] + config.start_after_s)
    share = 1.0 - run.learnt.sum() / max(int(had_voltage.sum()), 1)
    if share > UNBELIEVED:
        yield f"{share:.0%} of the voltages were not believed, because they are far from what was expected."
    noise_v = own_noise(record, config, response)
    lingering = _lingering(record, run)
    if rms_v > TIMES_NOISE * noise_v + LEAST_V or (lingering > LINGERING and rms_v > noise_v + LEAST_V):
        yield (
            f"The data contradict the model: it leaves {1e3 * rms_v:.3g} mV of a cell's voltage unexplained, while the "
            f"voltage's own noise is {1e3 * noise_v:.2g} mV. The open-circuit curve, temperature, hysteresis or slow "
            "relaxation may be the reason; the standard deviations are too small then."
        )


def _lingering(record: BatteryRecord, run: Run) -> float:
    """Return the correlation of neighbouring residuals in the second half of the record."""
    late = np.where(record.t_s >= 0.5 * (record.t_s[0] + record.t_s[-1]), run.residual_v, np.nan)
    late = np.where(run.learnt, late, np.nan)
    pairs = np.isfinite(late[:-1]) & np.isfinite(late[1:])
    first, second = late[:-1][pairs], late[1:][pairs]
    size = float(np.sum(first**2) + np.sum(second**2))
    return 2.0 * float(np.sum(first * second)) / size if size > 0.0 else 0.0
