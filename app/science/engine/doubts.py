"""What makes a trip's efficiencies doubtful: pulses that don't tell the fuel, or more work than there was fuel."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.moments import single_moments
from app.science.engine.points import OperatingPoints
from app.science.engine.rules import PointRules, settled
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import INJECTION_DOUBTS, Vehicle

IMPOSSIBLE_SHARE = 0.05
FEWEST_MOMENTS = 10
FEWEST_PLACES = 5
APART = 0.12
APART_OF_SCATTER = 4.0
SIDE_SHARE = 0.2
SPLIT_SHARE = 0.25
ROWS_TOGETHER = 5
RULES = PointRules()


def engine_doubts(
    observation: Observation, points: OperatingPoints, recording: Recording, vehicle: Vehicle
) -> tuple[str, ...]:
    """Return what is to be said of a trip's fuel and efficiency, in sentences; empty when nothing is.

    Parameters
    ----------
    observation : Observation
    points : OperatingPoints
        Of that observation.
    recording : Recording
        The measurements, which tell where the fuel comes from.
    vehicle : Vehicle
    """
    doubts = []
    by_pulses = "injector_pulse_s" in recording and "fuel_rate_lph" not in recording
    if by_pulses and vehicle.injection.system in INJECTION_DOUBTS:
        doubts.append(INJECTION_DOUBTS[vehicle.injection.system])
    elif by_pulses and _two_kinds_of_pulses(points):
        doubts.append(
            "Pulses of the same length brought two clearly different torques at the same engine speed, as when a "
            "second group of injectors, or another fuel pressure, comes in with load: fuel and efficiency of this trip "
            "are doubtful. Log the engine control unit's fuel rate (fuel_rate_lph) instead, and say in the car file "
            "how the engine injects."
        )
    share = _impossible_share(observation, vehicle) if points.torque_source == "observer" else 0.0
    if share > IMPOSSIBLE_SHARE:
        doubts.append(
            f"In {100.0 * share:.0f} % of the time at which the engine propelled the car more work came out than the "
            "energy of its fuel; those moments are left out of the map, and the others are doubtful. Check the "
            "injectors' flow or the fuel rate's scale, the fuel's energy, and the car's mass."
        )
    return tuple(doubts)


def _impossible_share(observation: Observation, vehicle: Vehicle) -> float:
    """Return the share of settled propelling moments whose work exceeds their fuel; 0 where fuel is unknown."""
    c = observation.columns
    power, fuel = c["thrust_n"] * c["speed_mps"], c["fuel_power_w"]
    propelling = (power > RULES.min_power_w) & (fuel > 0.0)
    if vehicle.gear_ratios and np.any(c["gear"] >= 1):
        propelling &= settled(c["t_s"], c["t_s"], c["gear"], RULES)
    return float(np.mean(fuel[propelling] <= power[propelling])) if propelling.any() else 0.0


def _two_kinds_of_pulses(points: OperatingPoints) -> bool:
    """Tell whether, fuel per turn and engine speed being the same, torque falls into two groups.

    In a place (100 rpm by 5 % of fuel) the widest gap between neighbouring torques splits the moments; it counts when
    it exceeds 12 % of the torque and four times the scatter on either side, with a fifth of the moments on each.
    """
    moments = single_moments(points)
    row = moments.k // ROWS_TOGETHER
    order = np.lexsort((moments.torque_sum, row, moments.i))
    torque, row, column = moments.torque_sum[order], row[order], moments.i[order]
    edges = np.flatnonzero((np.diff(column) != 0) | (np.diff(row) != 0)) + 1
    split = [_splits(place) for place in np.split(torque, edges) if len(place) >= FEWEST_MOMENTS]
    return len(split) >= FEWEST_PLACES and sum(split) >= SPLIT_SHARE * len(split)


def _splits(torque: FloatArray) -> bool:
    """Tell whether sorted torques fall into two groups."""
    fewest = max(round(SIDE_SHARE * len(torque)), 2)
    gap = np.diff(torque)[fewest - 1 : len(torque) - fewest]
    at = fewest + int(gap.argmax())
    scatter = max(float(torque[:at].std()), float(torque[at:].std()))
    widest = float(gap.max())
    return widest > APART * float(np.median(torque)) and widest > APART_OF_SCATTER * scatter
