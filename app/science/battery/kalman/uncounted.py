"""Charge that the current's sensor doesn't count, for the filter that has no state for the sensor's error."""

from __future__ import annotations

from app.science.arrays import FloatArray
from app.science.battery.config import BatteryConfig
from app.science.battery.kalman.belief import Belief
from app.science.battery.kalman.layout import SOC
from app.science.battery.kalman.residuals import Level
from app.science.battery.kalman.settling import Settled, settle
from app.science.battery.kalman.stretch import Ground

CONTRADICTED = 3.0
"""From this colour of the residuals on, what was counted and what the voltage says don't go together."""
CHANGES_S = 3600.0
"""The sensor's error is taken to be another one after so long: a walk of the charge instead of a steady loss."""
WORTH = 0.25
"""Share of its colour to which a residual must come down for the sensor's error to be blamed."""


def settle_uncounted(
    ground: Ground, config: BatteryConfig, first: int, last: int, belief: Belief, level: Level, walks: FloatArray
) -> tuple[Settled, FloatArray]:
    """Filter a stretch; where voltage and counted charge contradict each other, let the charge wander.

    Parameters
    ----------
    ground, first, last, belief, level, walks
        As `app.science.battery.kalman.settling.settle` takes them.
    config : BatteryConfig

    Returns
    -------
    Settled, ndarray (7,)
        And by how much variances grow from now on, per second.
    """
    settled = settle(ground, first, last, belief, level, walks)
    if settled.level.colour <= CONTRADICTED or walks[SOC] > 0.0 or last <= ground.learn_from:
        return settled, walks
    freer = walks.copy()
    freer[SOC] = (config.current_bias_a / config.cell.circuit.capacity_as) ** 2 * CHANGES_S
    other = settle(ground, first, last, belief, level, freer)
    if other.level.colour < WORTH * settled.level.colour:
        return other, freer
    # What was tried last has left its residuals behind.
    return settle(ground, first, last, belief, level, walks), walks
