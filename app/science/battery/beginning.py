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
MORE_ROOM, FAR_BETTER = 10.0, 0.5
MOST_TIMES = 3
PARAMETERS = VALUES[:4]


@dataclass(frozen=True, slots=True)
class Beginning:
    """A configuration to begin again with, and the share that the residuals must fall below for it to be the better."""

    config: BatteryConfig
    below: float = 1.0


def nearer_beginning(config: BatteryConfig, whole: WholeRun, contradicted: bool) -> Beginning | None:
    """Return a nearer place to begin at; None where the first one was near enough.

    A filter that begins many standard deviations off linearises in the wrong place, and is too sure of itself when it
    ends. What it found is the better place to begin at, with doubts as large as before; nothing is counted twice. Where
    the data contradict the model, the current's sensor may be further off than it was thought to be; it is given more
    room, and that counts if it explains the record far better.

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
    circuit, found, sds = config.cell.circuit, whole.run.values[-1, :4], whole.run.sds[-1, :4]
    thought = np.array([getattr(circuit, name) for name in PARAMETERS])
    doubt = np.array([config.initial_sd.get(name, INITIAL_SD[name]) for name in PARAMETERS])
    if np.any((np.abs(np.log(found / thought)) > FAR * doubt) & (sds < FOUND * found)):
        soc = float(np.clip(whole.initial_soc, 0.0, 1.0))
        return Beginning(replace(config, cell=replace(config.cell, circuit=Circuit(*map(float, found)), soc=soc)))
    if contradicted and config.estimator == "ekf_bias" and config.current_bias_a > 0.0:
        return Beginning(replace(config, current_bias_a=MORE_ROOM * config.current_bias_a), FAR_BETTER)
    return None
