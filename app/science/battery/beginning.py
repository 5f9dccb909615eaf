"""Where an estimate began too far from what it found, and where it should have begun."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from app.science.battery.circuit import Circuit
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.kalman.belief import INITIAL_SD
from app.science.battery.whole_run import WholeRun

FAR = 2.5
"""Standard deviations of what was thought, beyond which a parameter was found far from it."""
FOUND = 0.3
"""Relative standard deviation up to which a parameter has been found."""
MORE_ROOM, FAR_BETTER, CLEAR_CAPACITY = 10.0, 0.5, 0.05
LOST = 20.0
"""Times by which the capacity differs from what was configured, from which on it is no estimate any more."""
MOST_TIMES = 3
PARAMETERS = VALUES[:4]


@dataclass(frozen=True, slots=True)
class Beginning:
    """A configuration to begin again with, and whether it only says something else of the current's sensor."""

    config: BatteryConfig
    of_sensor: bool = False


def nearer_beginnings(
    first: BatteryConfig, config: BatteryConfig, whole: WholeRun, contradicted: bool
) -> Iterator[Beginning]:
    """Give nearer places to begin at, the best first; none where the first one was near enough.

    A filter that begins many standard deviations off linearises in the wrong place, and is too sure of itself when it
    ends. What it found is the better place to begin at, with doubts as large as before; nothing is counted twice. Where
    the data contradict the model, the current's sensor may be further off than it was thought to be, or so free that
    the filter was lost between its error and the charge.

    The report's estimator has no standard deviations of its own and is left as it is.

    Parameters
    ----------
    first : BatteryConfig
        As it was given.
    config : BatteryConfig
        As it was begun with now.
    whole : WholeRun
        What began with that configuration.
    contradicted : bool
        Whether the residuals are far above the voltage's own noise.
    """
    if config.estimator == "gpc":
        return
    sensor = contradicted and config.estimator == "ekf_bias" and config.current_bias_a > 0.0
    if sensor:
        yield Beginning(replace(first, current_bias_a=config.current_bias_a / MORE_ROOM), of_sensor=True)
    if _is_far(config, whole):
        soc = float(np.clip(whole.initial_soc, 0.0, 1.0))
        found = Circuit(*(float(value) for value in whole.run.values[-1, :4]))
        yield Beginning(replace(config, cell=replace(config.cell, circuit=found, soc=soc)))
    if sensor:
        yield Beginning(replace(first, current_bias_a=MORE_ROOM * config.current_bias_a), of_sensor=True)


def is_better(beginning: Beginning, before: WholeRun, after: WholeRun, rms_before_v: float, rms_after_v: float) -> bool:
    """Tell whether a run from another beginning is to be preferred.

    It must leave less of the voltage. Another error of the current's sensor must explain far more and leave the
    capacity clearer than before, and a larger one must clearly be there: with enough freedom anything can be explained.
    """
    if not beginning.of_sensor:
        return rms_after_v < rms_before_v
    capacity_sd = [float(whole.run.sds[-1, 0] / whole.run.values[-1, 0]) for whole in (before, after)]
    return rms_after_v < FAR_BETTER * rms_before_v and capacity_sd[1] < min(capacity_sd[0], CLEAR_CAPACITY)


def _is_far(config: BatteryConfig, whole: WholeRun) -> bool:
    """Tell whether a parameter was found far from where it began; what is lost was not found."""
    found, sds = whole.run.values[-1, :4], whole.run.sds[-1, :4]
    if not np.isfinite(whole.run.values[-1]).all():
        return False
    thought = np.array([getattr(config.cell.circuit, name) for name in PARAMETERS])
    doubt = np.array([config.initial_sd.get(name, INITIAL_SD[name]) for name in PARAMETERS])
    off = np.abs(np.log(found / thought))
    return bool(off[0] <= np.log(LOST) and np.any((off > FAR * doubt) & (sds < FOUND * found)))
