"""Is the truth where the covariance says? NEES of each group of states on virtual hours, filtered and smoothed.

The normalised estimation error squared is eᵀ P⁻¹ e over the states of a group; its mean is their number and 95 % of it
lie below the chi-square's bound where the covariance is right. The seeds were never used for tuning.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from app.cli.bench.figure import Figure
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.arrays import FloatArray
from app.science.logger.decode import decode_image
from app.science.observer import motion_kernels as motion
from app.science.observer.events import motion_events
from app.science.observer.motion import MotionResult, motion_model, observe_motion, start_state
from app.science.observer.timeline import build_timeline
from app.science.observer.tuning import DEFAULT
from app.science.roads.projection import LocalPlane
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

FRESH_SEEDS = (9501, 9502, 9503)
DURATION_S = 3600.0
EVERY = 20
SETTLE_S = 30.0
BOUND = 0.95
GROUPS = {
    "speed": (motion.V,),
    "thrust": (motion.F,),
    "pitch": (motion.TH,),
    "speed, thrust and pitch": (motion.V, motion.F, motion.TH),
    "heading": (motion.PSI,),
    "north, east and down": (motion.N, motion.E, motion.D),
    "curvatures": (motion.SJ, motion.SK),
    "biases": (motion.BI, motion.BJ, motion.BK),
}
COLUMNS = {
    motion.V: "speed_mps",
    motion.F: "thrust_n",
    motion.TH: "pitch_rad",
    motion.PSI: "heading_rad",
    motion.D: "down_m",
    motion.SJ: "curvature_h_radpm",
    motion.SK: "curvature_v_radpm",
    motion.BI: "bias_i_mps2",
    motion.BJ: "bias_j_mps2",
    motion.BK: "bias_k_mps2",
}


def measure() -> list[Figure]:
    """Return for every group, filtered and smoothed: mean NEES by number of states, and the share below the bound."""
    found: dict[tuple[str, bool], list[FloatArray]] = {}
    for seed in FRESH_SEEDS:
        note(f"an hour with seed {seed}")
        trip = simulate(Simulation(duration_s=DURATION_S, seed=seed))
        for smooth in (False, True):
            for group, values in group_nees(trip, smooth=smooth).items():
                found.setdefault((group, smooth), []).append(values)
    figures: list[Figure] = []
    for (group, smooth), hours in found.items():
        size = len(GROUPS[group])
        nees, where = np.concatenate(hours), f"{group}, {'smoothed' if smooth else 'filtered'}"
        below = 100.0 * float(np.mean(nees <= chi2.ppf(BOUND, size)))
        figures.append(Figure(f"{where}: NEES per state", float(nees.mean()) / size, "1", 1.0, "a right covariance"))
        figures.append(
            Figure(f"{where}: time below the bound", below, "%", 100.0 * BOUND, "a right covariance", "higher")
        )
    return figures


def layout(found: list[Figure]) -> list[list[str]]:
    """Return one row for each group."""
    value = {one.name: one.value for one in found}
    rows = [["states", *(f"{kind}, {what}" for kind in ("filtered", "smoothed") for what in ("NEES", "below bound"))]]
    for group in GROUPS:
        row = [group]
        for kind in ("filtered", "smoothed"):
            row += [f"{value[f'{group}, {kind}: NEES per state']:.2f}"]
            row += [f"{value[f'{group}, {kind}: time below the bound']:.1f} %"]
        rows.append(row)
    return rows


def group_nees(trip: SimulatedTrip, *, smooth: bool) -> dict[str, FloatArray]:
    """Return the NEES of each group at every second of a trip, shape (m,)."""
    recording, vehicle = decode_image(trip.image).recordings[0], read_vehicle(trip.car_xml)
    timeline = build_timeline(recording, vehicle)
    plane = LocalPlane(float(recording["lat_deg"].value[0]), float(recording["lon_deg"].value[0]))
    events = motion_events(recording, vehicle, timeline, DEFAULT, plane, read_elevation(trip.elevation_csv))
    x0, variance0 = start_state(recording, vehicle, timeline, plane)
    nodes = timeline.node_t_s
    seen = observe_motion(
        events, motion_model(vehicle, DEFAULT), x0, variance0, len(nodes), smooth=smooth, whole_every=EVERY
    )
    t = nodes[::EVERY]
    error, covariance = _errors(seen, trip, plane, t), seen.covariance
    if covariance is None:
        raise ValueError("the covariances were asked for")
    settled = (t > SETTLE_S) & (t < t[-1] - SETTLE_S)
    return {group: _nees(error[settled], covariance[settled], list(states)) for group, states in GROUPS.items()}


def _errors(seen: MotionResult, trip: SimulatedTrip, plane: LocalPlane, t_s: FloatArray) -> FloatArray:
    truth = trip.truth
    place = plane.forward(*(np.interp(t_s, truth["t_s"], truth[name]) for name in ("lat_deg", "lon_deg")))
    true = {state: np.interp(t_s, truth["t_s"], truth[name]) for state, name in COLUMNS.items()}
    true |= {motion.N: place.north_m, motion.E: place.east_m}
    error: FloatArray = seen.state[::EVERY].copy()
    for state, value in true.items():
        error[:, state] -= value
    error[:, motion.PSI] = np.angle(np.exp(1j * error[:, motion.PSI]))
    return error


def _nees(error: FloatArray, covariance: FloatArray, states: list[int]) -> FloatArray:
    own, spread = error[:, states], covariance[:, states][:, :, states]
    return np.asarray(np.einsum("ti,ti->t", own, np.linalg.solve(spread, own[:, :, None])[:, :, 0]))
