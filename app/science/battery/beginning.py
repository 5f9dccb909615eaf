"""Where an estimate began too far from what it found, and where it should have begun."""

from __future__ import annotations

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
MORE_ROOM, FAR_BETTER, CLEARLY, CLEAR_CAPACITY = 10.0, 0.5, 5.0, 0.05
LOST = 20.0
"""Times by which the capacity differs from what was configured, from which on it is no estimate any more."""
MOST_TIMES = 3
PARAMETERS = VALUES[:4]


@dataclass(frozen=True, slots=True)
class Beginning:
    """A configuration to begin again with, and whether it only gives the current's sensor more room."""

    config: BatteryConfig
    more_room: bool = False


def nearer_beginning(config: BatteryConfig, whole: WholeRun, contradicted: bool) -> Beginning | None:
    """Return a nearer place to begin at; None where the first one was near enough, or what was found is lost.

    A filter that begins many standard deviations off linearises in the wrong place, and is too sure of itself when it
    ends. What it found is the better place to begin at, with doubts as large as before; nothing is counted twice. Where
    the data contradict the model, the current's sensor may be further off than it was thought to be.

    The report's estimator has no standard deviations of its own and is left as it is.

    Parameters
    ----------
    config : BatteryConfig
    whole : WholeRun
        What began with that configuration.
    contradicted : bool
        Whether the residuals are far above the voltage's own noise.
    """
    if config.estimator == "gpc" or not np.isfinite(whole.run.values[-1]).all():
        return None
    found, sds = whole.run.values[-1, :4], whole.run.sds[-1, :4]
    thought = np.array([getattr(config.cell.circuit, name) for name in PARAMETERS])
    doubt = np.array([config.initial_sd.get(name, INITIAL_SD[name]) for name in PARAMETERS])
    off = np.abs(np.log(found / thought))
    if off[0] > np.log(LOST):
        return None
    if np.any((off > FAR * doubt) & (sds < FOUND * found)):
        soc = float(np.clip(whole.initial_soc, 0.0, 1.0))
        return Beginning(replace(config, cell=replace(config.cell, circuit=Circuit(*map(float, found)), soc=soc)))
    if contradicted and config.estimator == "ekf_bias" and config.current_bias_a > 0.0:
        return Beginning(replace(config, current_bias_a=MORE_ROOM * config.current_bias_a), more_room=True)
    return None


def is_better(beginning: Beginning, before: WholeRun, after: WholeRun, rms_before_v: float, rms_after_v: float) -> bool:
    """Tell whether a run from another beginning is to be preferred.

    It must leave less of the voltage. More room for the current's sensor must explain far more, by an error that is
    clearly there, and leave the capacity clearer than before: with enough freedom anything can be explained.
    """
    if not beginning.more_room:
        return rms_after_v < rms_before_v
    capacity_sd = [float(whole.run.sds[-1, 0] / whole.run.values[-1, 0]) for whole in (before, after)]
    clear = abs(float(after.run.bias_a[-1])) > CLEARLY * float(after.run.bias_sd_a[-1])
    return rms_after_v < FAR_BETTER * rms_before_v and clear and capacity_sd[1] < min(capacity_sd[0], CLEAR_CAPACITY)
