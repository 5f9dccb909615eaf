"""Open-circuit curves from slow charges and discharges, and from pulses with rests (MAUTC-2010-02, fig. 25)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import Circuit
from app.science.battery.curve import OpenCircuit
from app.science.battery.open_circuit_doubts import check_for_fit, contradiction, doubts_of_fit, unexplained
from app.science.battery.open_circuit_model import COARSE, KNOTS, LEAST_SWEEP, LONGEST_S, hats, regress, without
from app.science.battery.open_circuit_places import Placed, counted_capacity, of_one_cell, place, slow_current
from app.science.battery.record import BatteryRecord
from app.science.battery.strokes import strokes, voltage_limits
from app.science.errors import TooLittleData

LEAST_RISE_V = 1e-6
"""By which the curve's rows rise at least, so that a table ascends."""

LEAST_SECONDS = 5.0
"""That the data must spend around a state of charge for the curve to be known there."""


@dataclass(frozen=True, slots=True)
class FittedCurve:
    """An open-circuit curve, and how well it is known.

    Attributes
    ----------
    curve : OpenCircuit
        A table, of one cell.
    soc, volts : ndarray (m,)
        Its rows.
    spread_v : ndarray (m,)
        Charging less discharging voltage around each row, with the currents the data have; NaN where there is but one
        direction. Half of it is how far a curve read off one direction would be wrong.
    capacity_ah : float
        Of one cell, between the ends.
    resistance_ohm : ndarray (m,)
        Series resistance and all relaxations together: what was taken off the voltage, per ampere.
    misfit_v : float
        Root mean square of what curve and resistances leave unexplained.
    warnings : tuple of str
    """

    curve: OpenCircuit
    soc: FloatArray
    volts: FloatArray
    spread_v: FloatArray
    capacity_ah: float
    resistance_ohm: FloatArray
    misfit_v: float
    warnings: tuple[str, ...]


def fit_curve(
    records: BatteryRecord | Sequence[BatteryRecord],
    capacity_ah: float | None = None,
    series: int = 1,
    parallel: int = 1,
    limits_v: tuple[float, float] | None = None,
    circuit: Circuit | None = None,
    ends_soc: tuple[float, float] = (0.0, 1.0),
) -> FittedCurve:
    """Fit the open-circuit curve of one cell.

    Parameters
    ----------
    records : BatteryRecord or sequence of them
        Of the pack.
    capacity_ah : float, optional
        Of one cell; by default as counted between a full and an empty end.
    series, parallel : int
    limits_v : tuple of float, optional
        Voltages of one cell that count as empty and full; by default those that the records keep to.
    circuit : Circuit, optional
        What is taken off the voltage in the place of resistances found from the data: the curve is then the one with
        which this circuit explains these data, whatever else is in it.
    ends_soc : tuple of float
        States of charge that the two limits stand for, such as 0.1 and 0.9 where nobody went further.

    Raises
    ------
    TooLittleData
        When no end is reached, or only one and no capacity is given.
    SignalsError
        When the current is counted the wrong way round.
    """
    many = [records] if isinstance(records, BatteryRecord) else list(records)
    if not many:
        raise TooLittleData("There are no data to fit a curve to.")
    cells = [of_one_cell(record, series, parallel) for record in many]
    for cell in cells:
        check_for_fit(cell)
    lows, highs = zip(*(voltage_limits(cell) for cell in cells), strict=True)
    limits = limits_v or (float(np.nanmin(lows)), float(np.nanmax(highs)))
    slow_a = slow_current(cells, limits)
    counted, assumed = (capacity_ah, ()) if capacity_ah else counted_capacity(cells, limits, ends_soc, slow_a)
    placed = [place(cell, limits, counted, ends_soc, given=capacity_ah is not None, slow_a=slow_a) for cell in cells]
    regression = (
        regress(placed) if circuit is None else regress([without(one, circuit) for one in placed], curve_only=True)
    )
    known = np.flatnonzero(regression.seconds >= LEAST_SECONDS)
    if len(known) < 2:
        raise TooLittleData("The data stay at one state of charge; a curve needs data that move through it.")
    rows = slice(int(known[0]), int(known[-1]) + 1)
    soc = KNOTS[rows]
    volts = regression.volts[rows]
    volts = np.maximum.accumulate(volts) + LEAST_RISE_V * np.arange(len(volts))
    resistance = np.interp(soc, COARSE, regression.resistance_ohm.sum(axis=0))
    if circuit is not None:
        resistance = np.full_like(soc, circuit.resistance_ohm + circuit.relaxation_resistance_ohm)
    return FittedCurve(
        curve=OpenCircuit(points=tuple(zip(soc.tolist(), volts.tolist(), strict=True))),
        soc=soc,
        volts=volts,
        spread_v=_spread(placed, soc),
        capacity_ah=counted,
        resistance_ohm=resistance,
        misfit_v=regression.misfit_v,
        warnings=(
            *assumed,
            *doubts_of_fit(placed, counted, soc),
            *contradiction(placed, capacity_ah, ends_soc),
            *unexplained(regression.misfit_v),
        ),
    )


def _spread(placed: Sequence[Placed], soc: FloatArray) -> FloatArray:
    """Return by how much charging rows lie above discharging ones near each state of charge."""
    total = np.zeros((2, len(soc)))
    weight = np.zeros((2, len(soc)))
    for one in placed:
        record = one.record
        since_s = np.clip(np.diff(record.t_s, prepend=record.t_s[0]), 0.0, LONGEST_S)
        for stroke in strokes(record):
            rows = np.arange(stroke.begin, stroke.end)
            rows = rows[np.isfinite(record.voltage_v[rows])]
            if stroke.direction == 0 or len(rows) == 0 or np.ptp(one.soc[rows]) < LEAST_SWEEP:
                continue
            shares = hats(soc, one.soc[rows]) * since_s[rows, None]
            total[int(stroke.direction > 0)] += shares.T @ record.voltage_v[rows]
            weight[int(stroke.direction > 0)] += shares.sum(axis=0)
    mean = np.divide(total, weight, where=weight > 0.0, out=np.full_like(total, np.nan))
    return np.asarray(mean[1] - mean[0])
