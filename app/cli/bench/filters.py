"""Every filter of the thesis on the same virtual hours: its speed, its errors, and the map that comes of it.

The seeds were never used for tuning. Errors are the root mean square over all hours.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.cli.bench.dense_observer import run_dense
from app.cli.bench.figure import Figure, timed
from app.cli.bench.truth import observed_errors
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.observer.events import motion_events
from app.science.observer.family.methods import FILTERS
from app.science.observer.motion import motion_model, start_state
from app.science.observer.observe import observe
from app.science.observer.timeline import build_timeline
from app.science.observer.tuning import DEFAULT, THESIS_2010, Tuning
from app.science.roads.projection import LocalPlane
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

FRESH_SEEDS = (9201, 9202, 9203)
DENSE_EVENTS = 4000
DENSE_FROM = 20000
COLUMNS = (
    ("speed_mps", "speed", "m/s"),
    ("pitch_rad", "pitch", "°"),
    ("thrust_n", "thrust", "N"),
    ("engine_speed_radps", "ω_e", "rad/s"),
    ("fuel_power_w", "P_in", "W"),
    ("efficiency", "η", "1"),
    ("map", "map", "1"),
    ("cells", "trusted cells", "1"),
)


@dataclass(frozen=True, slots=True)
class Variant:
    """A filter with its tuning under a name."""

    name: str
    filter: str
    tuning: Tuning


VARIANTS = (
    *(Variant(name, name, DEFAULT) for name in FILTERS),
    Variant("ekf, thrust of order 2", "ekf", replace(DEFAULT, thrust_order=2)),
    Variant("ekf, thrust of order 3", "ekf", replace(DEFAULT, thrust_order=3)),
    Variant("rk4-ekf, thesis-2010", "rk4-ekf", THESIS_2010),
)


def measure() -> list[Figure]:
    """Return for every variant, smoothed and not: µs per event against plain ways, and each error against ``ekf``."""
    errors: dict[tuple[str, bool], list[dict[str, float]]] = {}
    micros: dict[tuple[str, bool], float] = {}
    plain: dict[str, float] = {}
    for number, seed in enumerate(FRESH_SEEDS):
        note(f"an hour with seed {seed}")
        trip = simulate(Simulation(duration_s=3600.0, seed=seed))
        if number == 0:
            plain = _plain_micros(trip)
            micros = {(v.name, smooth): _micros(trip, v, smooth) for v in VARIANTS for smooth in (True, False)}
        for variant in VARIANTS:
            for smooth in (True, False):
                found = observed_errors(trip, tuning=variant.tuning, filter=variant.filter, smooth=smooth)
                errors.setdefault((variant.name, smooth), []).append(found)
    figures: list[Figure] = []
    for key in errors:
        figures += _figures(key, micros, plain, errors)
    return figures


def layout(figures: list[Figure]) -> list[list[str]]:
    """Return the figures as one line per filter."""
    heads = [
        "filter",
        "µs/event",
        "NumPy ×",
        "filterpy ×",
        "default ×",
        *(f"{name}, {unit}" for _, name, unit in COLUMNS),
    ]
    lines: dict[str, list[str]] = {}
    for one in figures:
        filter_name, what = one.name.split(": ")
        line = lines.setdefault(filter_name, [filter_name])
        if what == "per event":
            line += [f"{one.value:.2f}", f"{one.ratio:.0f}"]
        elif what == "per event beside filterpy":
            line.append(f"{one.ratio:.0f}")
        elif what == "per event beside the default":
            line.append(f"{one.ratio:.2f}")
        else:
            line.append(f"{one.value:.4g}")
    return [heads, *lines.values()]


def _figures(
    key: tuple[str, bool],
    micros: dict[tuple[str, bool], float],
    plain: dict[str, float],
    errors: dict[tuple[str, bool], list[dict[str, float]]],
) -> list[Figure]:
    name, smooth = key
    where, usual = f"{name}, {'smoothed' if smooth else 'filtered'}", ("ekf", smooth)
    goal = ("at most 2.2" if smooth else "at most 1.2") if name == "ekf" else ""
    found = [
        Figure(f"{where}: per event", micros[key], "µs", plain["NumPy"], "dense NumPy, EKF", goal=goal),
        Figure(f"{where}: per event beside filterpy", micros[key], "µs", plain["filterpy"], "filterpy's EKF"),
        Figure(f"{where}: per event beside the default", micros[key], "µs", micros[usual], "ekf"),
    ]
    for column, label, unit in COLUMNS:
        own, default = (_over_hours([hour[column] for hour in errors[k]], column) for k in (key, usual))
        better = "higher" if column == "cells" else "lower"
        found.append(Figure(f"{where}: {label}", own, unit, default, "ekf", better))  # type: ignore[arg-type]
    return found


def _over_hours(values: list[float], column: str) -> float:
    return float(np.mean(values)) if column == "cells" else float(np.sqrt(np.mean(np.square(values))))


def _micros(trip: SimulatedTrip, variant: Variant, smooth: bool) -> float:
    """Return the best of two runs after a first one, µs per measurement event."""
    recording, elevation = decode_image(trip.image).recordings[0], read_elevation(trip.elevation_csv)

    def work() -> int:
        seen = observe(
            recording, trip.vehicle, elevation=elevation, tuning=variant.tuning, filter=variant.filter, smooth=smooth
        )
        return seen.events

    events = work()
    return 1e6 * min(timed(work) for _ in range(2)) / events


def _plain_micros(trip: SimulatedTrip) -> dict[str, float]:
    """Return µs per event of the extended filter with smoother in dense NumPy, and with filterpy's corrections."""
    recording = decode_image(trip.image).recordings[0]
    timeline = build_timeline(recording, trip.vehicle)
    plane = LocalPlane(float(recording["lat_deg"].value[0]), float(recording["lon_deg"].value[0]))
    elevation = read_elevation(trip.elevation_csv)
    events = motion_events(recording, trip.vehicle, timeline, DEFAULT, plane, elevation)
    piece = events.between(DENSE_FROM, DENSE_FROM + DENSE_EVENTS)
    x0, variance0 = start_state(recording, trip.vehicle, timeline, plane)
    model = motion_model(trip.vehicle, DEFAULT)
    per_event = 1e6 / len(np.unique(piece.t_s))
    return {
        "NumPy": per_event * timed(lambda: run_dense(piece, model, x0, variance0, filterpy=False)),
        "filterpy": per_event * timed(lambda: run_dense(piece, model, x0, variance0)),
    }
