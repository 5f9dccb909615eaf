"""What is known of a route's drive, in one certificate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from app.science.optimal.answer import Certificate, Independent, Verdict
from app.science.optimal.problem import Route
from app.science.optimal.route.polish.burning import on_spline
from app.science.optimal.route.polish.polishing import Polished

SMOOTH = 1e-6
SMOOTH_SPLINE = 5e-5
"""Of the largest fuel power: within it the principle holds. A CVT's least fuel over power is known by a spline."""
CLOSED = 1e-4
"""Of the fuel: gap to the lower bound that counts as closed."""
EVEN = 1e-4
"""Of the largest fuel power: jumps of H at changes of gear that count as none, as their places are known to 1 cm."""
DUALITY = "lower bound by weak duality with the drive's own costates, over all speeds, gears and controls"
GRID = "lower bound by weak duality of dynamic programming over distance, energy and gear, for drives on its grid"


def certify(
    problem: Route, drive: Polished, grid_j: float | None = None, more: Mapping[str, Any] | None = None
) -> Certificate:
    """Return a polished drive's certificate.

    Parameters
    ----------
    problem : Route
    drive : Polished
    grid_j : float or None
        The bound of fuel and charges together that dynamic programming finds for drives on its own grid.
    more : mapping or None
        Further numbers.
    """
    shown = drive.trajectory
    peak = float(shown.fuel_power_w.max())
    smooth = SMOOTH_SPLINE if on_spline(problem) else SMOOTH
    changes = int((abs(shown.gear[1:] - shown.gear[:-1]) > 0).sum())
    charges = problem.transmission.shift_cost_j * changes
    taken = drive.fuel_j + charges
    gap = (taken - drive.lower_bound_j) / taken
    other = Independent(DUALITY, gap)
    if problem.transmission.kind == "gears" and grid_j is not None:
        other = Independent(GRID, (taken - grid_j) / taken)
    late_w = drive.price_w * abs(1.0 - drive.time_s / problem.max_time_s) if problem.max_time_s is not None else 0.0
    holds = max(drive.hamiltonian_drift_w, drive.max_h_minus_mu_w) <= smooth * peak
    holds &= drive.switch_defect_w <= EVEN * peak
    verdict: Verdict = "best found"
    if holds:
        verdict = "optimal" if gap <= CLOSED else "extremal"
    return Certificate(
        hamiltonian_drift_w=drive.hamiltonian_drift_w,
        transversality=late_w,
        max_h_minus_mu_w=drive.max_h_minus_mu_w,
        independent=other,
        verdict=verdict,
        notes=_notes(drive, smooth * peak, EVEN * peak, gap),
        more={
            **(more or {}),
            "lower_bound_j": drive.lower_bound_j,
            "shift_charges_j": charges,
            "switch_defect_w": drive.switch_defect_w,
        },
    )


def _notes(drive: Polished, smooth_w: float, even_w: float, gap: float) -> tuple[str, ...]:
    """Return what keeps the verdict from being better."""
    said = []
    if drive.jumps:
        said.append(
            f"The costate of speed jumps at {drive.jumps} places where the drive touches a speed limit or an engine "
            "speed's, as the maximum principle with limits on the state allows; H does not."
        )
    if drive.switch_defect_w > even_w:
        said.append(
            f"At a change of gear H jumps by up to {drive.switch_defect_w:.3g} W: it would better be elsewhere, "
            "or more changes would pay."
        )
    if drive.max_h_minus_mu_w > smooth_w:
        said.append(
            f"Somewhere another gear or control has an H that is {drive.max_h_minus_mu_w:.3g} W higher: changing to it "
            "for a moment would pay. The gap says by how much at most all such changes together could."
        )
    if gap > CLOSED:
        said.append(
            f"The lower bound is {100.0 * gap:.2g} % below the drive. It lets controls and gears alternate for free as "
            "often as they like, which no drive can."
        )
    return tuple(said)
