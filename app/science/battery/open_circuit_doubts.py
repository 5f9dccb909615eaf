"""What is to be said about the data behind an open-circuit curve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.open_circuit_model import LEAST_SWEEP
from app.science.battery.open_circuit_places import CONTRADICTED, Placed
from app.science.battery.record import BatteryRecord
from app.science.battery.strokes import charge_ah, strokes
from app.science.errors import SignalsError, TooLittleData

SLOW_PER_H = 0.11
"""Share of the capacity per hour up to which a charge or discharge is slow."""

LONG_REST_S = 600.0
"""Rest after which most of the voltage's lag is gone."""

ENOUGH_RESTS = 3
"""Long rests on the way that make up for a fast sweep."""

UNEQUAL = 1.03
"""Ratio of the largest counted capacity to the smallest from which they differ."""


LARGE_MISFIT_V = 0.012
"""Left unexplained on average, from which on the data are not those of one cell as the regression knows it."""

HIGHEST_CELL_V = 6.0
"""Above which no cell's voltage is."""

AGAINST = -0.7
"""Correlation of voltage and charge below which the current is counted the wrong way round."""


def check_for_fit(cell: BatteryRecord) -> None:
    """Refuse a record that can't show a curve, whatever else is told.

    Raises
    ------
    TooLittleData
        Without voltages that move or without a current.
    SignalsError
        When charging lowers the voltage, or the voltage is none of a cell.
    """
    rows = np.flatnonzero(np.isfinite(cell.voltage_v))
    charge, volts = charge_ah(cell)[rows], cell.voltage_v[rows]
    if len(rows) < 2 or np.ptp(charge) == 0.0:
        raise TooLittleData(
            f"{len(rows)} rows have a voltage and {np.ptp(charge) if len(rows) else 0.0:.3g} Ah flow between them; a "
            "curve needs data that move through it."
        )
    if volts.max() > HIGHEST_CELL_V:
        raise SignalsError(
            f"One cell would have {volts.max():.4g} V, which no cell has. Say how many cells stand in series.",
            field="voltage_v",
        )
    if np.ptp(volts) == 0.0:
        raise TooLittleData(f"The voltage stays at {volts[0]:.4g} V while charge flows: its sensor seems to be frozen.")
    if np.corrcoef(charge, volts)[0, 1] < AGAINST:
        raise SignalsError(
            "The voltage falls as charge comes in: the current's sign seems to be swapped. Charging must be positive.",
            field="current_a",
        )


def doubts_of_fit(placed: Sequence[Placed], capacity_ah: float, soc: FloatArray) -> Iterator[str]:
    """Tell what a curve's data leave open: speed, direction, coverage, and what was taken for granted."""
    sweeps = [
        (stroke.direction, float(np.median(np.abs(one.record.current_a[stroke.begin : stroke.end]))) / capacity_ah)
        for one in placed
        for stroke in strokes(one.record)
        if stroke.direction and np.ptp(one.soc[stroke.begin : stroke.end]) >= LEAST_SWEEP
    ]
    directions, slowest = {direction for direction, _ in sweeps}, min((rate for _, rate in sweeps), default=0.0)
    rested = _rests(placed) >= ENOUGH_RESTS
    if slowest > SLOW_PER_H and not rested:
        yield (
            f"The slowest charge or discharge moves {slowest:.2g} of the capacity per hour; at more than "
            f"{SLOW_PER_H:.2g} the voltage lags behind, and what resistances do not explain of it is in the curve."
        )
    if len(directions) == 1:
        yield (
            f"The data move through the curve while {'charging' if 1 in directions else 'discharging'} only: half of "
            f"any hysteresis is in the curve{'.' if rested else ', and so is part of the voltage over resistances.'}"
        )
    if soc[0] > 0.0 or soc[-1] < 1.0:
        yield f"The data cover states of charge from {soc[0]:.2f} to {soc[-1]:.2f}; the curve is known there only."
    if any(end.taken for one in placed for end in one.ends):
        yield "The data begin at rest at their highest voltage, which is taken as full."
    capacities = [capacity for one in placed for capacity in one.capacities_ah]
    if capacities and max(capacities) > UNEQUAL * min(capacities):
        yield (
            f"Capacities counted between full and empty run from {min(capacities):.4g} to {max(capacities):.4g} Ah; "
            "each stretch counts as one whole capacity of its own."
        )


def contradiction(placed: Sequence[Placed], given_ah: float | None, ends_soc: tuple[float, float]) -> Iterator[str]:
    """Tell that the charge between two ends is not what a capacity that was given makes of it."""
    if given_ah is None:
        return
    share = ends_soc[1] - ends_soc[0]
    capacities = [capacity for one in placed for capacity in one.capacities_ah]
    off = [one for one in capacities if abs(one / (given_ah * share) - 1.0) > CONTRADICTED]
    if off:
        yield (
            f"Between what was taken for full and for empty {off[0]:.4g} Ah flow, {off[0] / given_ah:.0%} of the "
            "capacity given. The full end is believed; say which states of charge the ends are if that is wrong."
        )


def unexplained(misfit_v: float) -> Iterator[str]:
    """Tell that one curve with one set of resistances does not explain the data."""
    if misfit_v > LARGE_MISFIT_V:
        yield (
            f"One curve and one set of resistances leave {1e3 * misfit_v:.0f} mV rms unexplained: the data may be of "
            "several cells, temperatures or wirings. Fit them apart."
        )


def _rests(placed: Sequence[Placed]) -> int:
    """Return how many long rests lie on the way between empty and full."""
    return sum(
        stroke.direction == 0
        and float(np.ptp(one.record.t_s[stroke.begin : stroke.end])) >= LONG_REST_S
        and LEAST_SWEEP < float(one.soc[stroke.begin]) < 1.0 - LEAST_SWEEP
        for one in placed
        for stroke in strokes(one.record)
    )
