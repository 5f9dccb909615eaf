"""The report's gPC estimator of a cell's parameters and charge (MAUTC-2010-02, part 3)."""

from __future__ import annotations

import numpy as np

from app.science.battery.config import BatteryConfig, Gains
from app.science.battery.gpc_running import Law, run_law
from app.science.battery.gpc_step_kernels import ALPHA, BETA, X10, XI, R
from app.science.battery.run import Carry, CellRecord, Run
from app.science.progress import Progress, silent

REPORT_AH = 2.2
"""What the capacity is first thought to be in Table 7."""


def run_gpc(record: CellRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent) -> Run:
    """Estimate by the report's recursive law, eqs 57 to 89.

    Moments are gathered from the start on, not before: what is seen while the charge is still thought to be elsewhere
    would be linearised at the wrong place of the curve and pull at the parameters for days.

    Raises
    ------
    EstimatorDiverged
        When the parameters stop being finite.
    """
    gains = suited(config.gpc.gains, config.cell.circuit.capacity_ah)
    diagonal = np.empty(5)
    diagonal[ALPHA], diagonal[R], diagonal[BETA] = gains.alpha, gains.r, gains.beta
    diagonal[XI], diagonal[X10] = gains.xi, gains.x10
    law = Law(config.gpc.terms, config.gpc.sigma_range_1ps, diagonal, np.inf, 0, 0.0, "Widen sigma_range_1ps")
    return run_law(record, config, law, carry, progress)


def suited(gains: Gains, capacity_ah: float) -> Gains:
    """Return gains for a cell of another size where they are the ones of Table 8, found for 2 Ah by trial and error.

    Up to twice or half of the report's first guess they hold as printed. Beyond, current and charge are taken to be as
    many times larger as the capacity is; so scaled, the parameters move by the same shares of themselves.
    """
    size = capacity_ah / REPORT_AH
    if gains != Gains() or 0.5 <= size <= 2.0:
        return gains
    return Gains(gains.alpha / size**2, gains.r / size**2, gains.beta / size**2, gains.xi, gains.x10 * size**2)
