"""Charge that the current's sensor counts wrongly in a way that a constant error doesn't explain."""

from __future__ import annotations

from app.science.arrays import FloatArray
from app.science.battery.config import BatteryConfig
from app.science.battery.kalman.belief import Belief
from app.science.battery.kalman.layout import BIAS, SOC
from app.science.battery.kalman.residuals import Level
from app.science.battery.kalman.settling import CONTRADICTED, Settled, settle
from app.science.battery.kalman.stretch import Ground

CHANGES_S = 3600.0
"""The sensor's error is then taken to become another one over so long."""
WORTH = 0.25
"""Share of its colour to which a residual must come down for the sensor to be blamed."""


def settle_uncounted(
    ground: Ground, config: BatteryConfig, first: int, last: int, belief: Belief, level: Level, walks: FloatArray
) -> tuple[Settled, FloatArray]:
    """Filter a stretch; where voltage and counted charge contradict each other, see whether the sensor is to blame.

    With a state for the sensor's error that error may wander, without one the charge. Where that leaves a white
    residual, it stays so; where not, the model is at fault, and a sensor that bends to it would only spoil the charge.

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
    state, rate = (BIAS, 1.0 / CHANGES_S) if ground.bias else (SOC, CHANGES_S / config.cell.circuit.capacity_as**2)
    rate *= config.current_bias_a**2
    if settled.level.colour <= CONTRADICTED or walks[state] >= rate or last <= ground.learn_from:
        return settled, walks
    freer = walks.copy()
    freer[state] = rate
    other = settle(ground, first, last, belief, level, freer)
    if other.level.colour < min(WORTH * settled.level.colour, CONTRADICTED):
        return other, freer
    # What was tried last has left its residuals behind.
    return settle(ground, first, last, belief, level, walks), walks
