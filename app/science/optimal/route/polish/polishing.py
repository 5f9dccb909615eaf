"""A plan by stages to a drive that is the least for its gears to high accuracy, and what is known of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.answer import Trajectory
from app.science.optimal.problem import Route
from app.science.optimal.route.plan import Plan
from app.science.optimal.route.polish.bounding import lower_bound_j
from app.science.optimal.route.polish.burning import Powertrain, on_spline, powertrain_of
from app.science.optimal.route.polish.hamiltonian import drifts_of, touches
from app.science.optimal.route.polish.interior_point import FIRST, ROUNDS, Found, InteriorPoint
from app.science.optimal.route.polish.kinks import cut_at, kinks_of
from app.science.optimal.route.polish.maximality import largest_h_minus_mu_w
from app.science.optimal.route.polish.mesh import Mesh, elements_of, mesh_of, refined
from app.science.optimal.route.polish.restart import carried, energies_at
from app.science.optimal.route.polish.switches import Switches, free, moved, rescheduled, switches_of
from app.science.optimal.route.polish.tracing import rows_of, traced
from app.science.progress import Progress, between, silent

WARM = 1e-5
FINE_M, COARSE_M, LONG_M = 25.0, 50.0, 40_000.0
KINK_ROUNDS = 4
SETTLED_M = 1e-5
STEADY, STEADY_SPLINE = 5e-7, 2e-5
"""Of the largest fuel power: H may change by that within an arc."""
HALVINGS = 3
SHIFT_ROUNDS = 16
LONG_TRIES = 70
"""Rounds for a try to move changes of gear on a long road, where a try that needs more hardly ever settles."""
RADIUS_M = 0.01, 30.0, 100.0
NOISE = 2e-7
"""Of the fuel: what another mesh changes."""
PULSES, WORTH = 24, 1e-5
"""With more changes of gear than that a drive pulses; its changes then move only as long as that share is gained."""
EVEN = 5e-5
"""Of the mean fuel power: jumps of H at changes of gear that are small enough."""


@dataclass(frozen=True, slots=True)
class Polished:
    """A drive that no small change makes cheaper, for the gears of its plan.

    Attributes
    ----------
    trajectory : Trajectory
    costates : mapping
        ``speed`` λ_v, J s/m, and ``distance`` λ_x, J/m, each array of shape (n,) along the trajectory.
    price_w : float
        Of a second; 0 where time is free or there is more than is needed.
    fuel_j, time_s : float
    hamiltonian_drift_w : float
        Largest change of H within a smooth arc, with costates integrated by their own equations.
    max_h_minus_mu_w : float
        Largest H − μ of a dense grid of all admissible controls along the drive.
    lower_bound_j : float
        What no drive within the limits burns less than.
    switch_defect_w : float
        Largest jump of H at a change of gear that has room to move.
    jumps : int
        How often the costate of speed jumps, where a limit of the speed is touched.
    """

    trajectory: Trajectory
    costates: dict[str, FloatArray]
    price_w: float
    fuel_j: float
    time_s: float
    hamiltonian_drift_w: float
    max_h_minus_mu_w: float
    lower_bound_j: float
    switch_defect_w: float
    jumps: int


def polish(problem: Route, plan: Plan, progress: Progress) -> Polished | None:
    """Polish a plan, keeping its gears.

    Parameters
    ----------
    problem : Route
    plan : Plan
        A drive that the limits allow, or nearly.
    progress : callable

    Returns
    -------
    Polished or None
        None where no drive settles, or where it would take two controls in turn; the plan then is the best that is
        known. Whether a polished drive is cheaper than its plan is for the caller to compare.
    """
    power = powertrain_of(problem)
    found = settled(problem, power, plan, between(progress, 0.0, 0.9))
    if found is None:
        return None
    motion = found.look.motion
    if power.needs_turns(motion.speed_mps, motion.force_n + found.point.brake_n):
        return None
    return told(problem, power, found)


def settled(problem: Route, power: Powertrain, plan: Plan, progress: Progress) -> Found | None:
    """Return the drive of least fuel for a plan's run of gears, on a mesh that ends at every kink; None for none."""
    longest = FINE_M if plan.edges_m[-1] - plan.edges_m[0] < LONG_M else COARSE_M
    mesh = elements_of(problem, plan, longest)
    half = 0.5 * problem.load.accelerated_mass_kg
    energies = half * np.interp(mesh.nodes_m, plan.edges_m, plan.speed_mps**2)
    method = InteriorPoint(problem, power, mesh)
    found = method.run(method.started(energies, plan.price_w, FIRST), between(progress, 0.0, 0.2), FIRST)
    if not found.settled:
        return None
    base = refined(problem, mesh, found.point.nodes_j)
    if len(np.unique(mesh.gear)) > 1:
        base, found = shifted(problem, power, base, found, between(progress, 0.2, 0.6))
    found = at_kinks(problem, power, base, found, between(progress, 0.6, 0.9))
    return smoother(problem, power, base, found, between(progress, 0.9, 1.0))


def smoother(problem: Route, power: Powertrain, base: Mesh, found: Found, progress: Progress) -> Found:
    """Halve the elements of arcs along which H changes by more than it should, and solve again."""
    for k in range(HALVINGS):
        progress(k / HALVINGS)
        drive = traced(problem, power, found)
        most = (STEADY_SPLINE if on_spline(problem) else STEADY) * float(drive.fuel_power_w.max())
        arcs = [one.elements for one in drifts_of(problem, found, drive) if one.watts > most]
        if not arcs:
            break
        inside = found.mesh.edges_m[np.concatenate(arcs)] + 0.5 * found.mesh.length_m[np.concatenate(arcs)]
        cut = np.unique(np.clip(np.searchsorted(base.edges_m, inside) - 1, 0, len(base.gear) - 1))
        finer = np.sort(np.append(base.edges_m, base.edges_m[cut] + 0.5 * base.length_m[cut]))
        count = np.ones(len(base.gear), dtype=np.int64)
        count[cut] = 2
        base = mesh_of(problem, finer, np.repeat(base.gear, count))
        tried = warm(problem, power, cut_at(problem, base, kinks_of(problem, found)), found, silent)
        if not tried.settled:
            break
        found = tried
    return found


def at_kinks(problem: Route, power: Powertrain, base: Mesh, found: Found, progress: Progress) -> Found:
    """Return the drive on a mesh with edges where other limits begin to hold; they are found in a few rounds.

    The last one that settled is returned.
    """
    kinks: FloatArray | None = None
    tried = found
    for k in range(KINK_ROUNDS):
        places = kinks_of(problem, tried)
        if kinks is not None and places.shape == kinks.shape and np.abs(places - kinks).max(initial=0.0) < SETTLED_M:
            break
        kinks = places
        share = between(progress, k / KINK_ROUNDS, (k + 1.0) / KINK_ROUNDS)
        tried = warm(problem, power, cut_at(problem, base, kinks), tried, share)
        found = tried if tried.settled else found
    return found


def shifted(problem: Route, power: Powertrain, base: Mesh, found: Found, progress: Progress) -> tuple[Mesh, Found]:
    """Move the changes of gear to where a metre costs the same on both sides; return the mesh without kinks, too."""
    ends = float(base.edges_m[0]), float(base.edges_m[-1])
    cut = warm(problem, power, cut_at(problem, base, kinks_of(problem, found)), found, silent)
    is_long = ends[1] - ends[0] >= LONG_M
    if is_long and not cut.settled:
        return base, found  # with moved changes it settles no better, and each try is dear
    found = cut if cut.settled else found
    radius = RADIUS_M[1]
    tries = LONG_TRIES if is_long else ROUNDS
    now = switches_of(InteriorPoint(problem, power, found.mesh), found, radius)
    for k in range(SHIFT_ROUNDS):
        progress(k / SHIFT_ROUNDS)
        if radius < RADIUS_M[0] or worst_w(now, ends) <= EVEN * found.look.fuel_j / found.look.time_s:
            break
        places = moved(now, *ends)
        other = rescheduled(problem, base, now.at_m, places, now.gears)
        tried = warm(problem, power, cut_at(problem, other, kinks_of(problem, found)), found, silent, tries)
        gained = (found.look.fuel_j - tried.look.fuel_j) / found.look.fuel_j
        then = switches_of(InteriorPoint(problem, power, tried.mesh), tried, radius)
        evener = worst_w(then, ends) < worst_w(now, ends)
        if tried.settled and (gained > NOISE or (gained > -NOISE and evener)):
            base, found, now = other, tried, then
            radius = min(2.0 * radius, RADIUS_M[2])
            if gained < WORTH and len(places) > PULSES:
                break
        else:
            radius = 0.2 * min(radius, float(np.abs(places - now.at_m).max()))
            now = switches_of(InteriorPoint(problem, power, found.mesh), found, radius)
    return base, found


def worst_w(switches: Switches, ends_m: tuple[float, float]) -> float:
    """Return the largest jump of H at a change of gear that has room to move."""
    return float(switches.defects_w[free(switches, *ends_m)].max(initial=0.0))


def warm(
    problem: Route, power: Powertrain, mesh: Mesh, before: Found, progress: Progress, rounds: int = ROUNDS
) -> Found:
    """Solve on another mesh from a drive that is nearly the best."""
    method = InteriorPoint(problem, power, mesh, rounds)
    energies = energies_at(before.mesh, before.point.nodes_j, mesh.nodes_m)
    start = carried(before, mesh, method.started(energies, before.point.price_w, WARM), WARM)
    return method.run(start, progress, WARM)


def told(problem: Route, power: Powertrain, found: Found) -> Polished:
    """Return a drive with what is known of it."""
    drive = traced(problem, power, found)
    rows = rows_of(problem, power, found, drive)
    switches = switches_of(InteriorPoint(problem, power, found.mesh), found, RADIUS_M[0])
    return Polished(
        trajectory=rows.trajectory,
        costates={"distance": rows.distance_costate, "speed": rows.speed_costate},
        price_w=found.point.price_w,
        fuel_j=found.look.fuel_j,
        time_s=found.look.time_s,
        hamiltonian_drift_w=max((one.watts for one in drifts_of(problem, found, drive)), default=0.0),
        max_h_minus_mu_w=largest_h_minus_mu_w(problem, power, found, drive),
        lower_bound_j=lower_bound_j(problem, power, found, drive),
        switch_defect_w=worst_w(switches, (float(found.mesh.edges_m[0]), float(found.mesh.edges_m[-1]))),
        jumps=int(touches(found).sum()),
    )
