"""What a trip gains from the car's earlier ones: its first minutes with and without their biases.

The biases of each trip are the car's own plus a change from trip to trip as large as is expected.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.cli.bench.figure import Figure
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.engine.accuracy import map_error
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.logger.decode import decode_image
from app.science.observer.carry_over import TRIP_TO_TRIP_SD_MPS2, BiasPrior, FinalBias, bias_prior, final_bias
from app.science.observer.observe import observe
from app.science.observer.result import Observation
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

CARS = (9301, 9302, 9303)
EARLIER = 3
DURATIONS_S = (1800.0, 1800.0, 1800.0, 1800.0, 300.0)
"""Of a car's trips; the last two are looked at, each as if it followed the first three."""
FIRST_S = 180.0
LOAD_KG = 75.0
RUNS = (
    ("filtered", False, frozenset[str]()),
    ("smoothed", True, frozenset[str]()),
    ("GPS only, filtered", False, frozenset({"dem"})),
    ("GPS only, smoothed", True, frozenset({"dem"})),
)


@dataclass(frozen=True, slots=True)
class Errors:
    """Root mean squares in the first minutes, and the map's over the whole trip."""

    pitch_deg: float
    thrust_n: float
    eta: float


def trips_of_car(seed: int, durations_s: tuple[float, ...]) -> list[SimulatedTrip]:
    """Drive one car several times; its biases change a little from trip to trip."""
    rng = np.random.default_rng(seed)
    own = rng.uniform(0.05, 0.2, 3) * rng.choice([-1.0, 1.0], 3)
    driven: list[SimulatedTrip] = []
    for number, duration_s in enumerate(durations_s):
        i, j, k = (float(bias) for bias in own + TRIP_TO_TRIP_SD_MPS2 * rng.standard_normal(3))
        spec = Simulation(duration_s=duration_s, seed=seed + 10 * number, bias_mps2=(i, j, k))
        driven.append(simulate(replace(spec, vehicle=driven[0].vehicle if driven else None)))
    return driven


def look(trip: SimulatedTrip, prior: BiasPrior | None, smooth: bool, without: frozenset[str]) -> Observation:
    """Observe a trip."""
    recording, elevation = decode_image(trip.image).recordings[0], read_elevation(trip.elevation_csv)
    return observe(recording, trip.vehicle, elevation=elevation, smooth=smooth, without=without, bias_prior=prior)


def prior_of(trips: list[SimulatedTrip], without: frozenset[str]) -> BiasPrior | None:
    """Return what trips that were driven one after another say of the next."""
    known: list[FinalBias] = []
    for trip in trips:
        bias = final_bias(look(trip, bias_prior(known, LOAD_KG), True, without), LOAD_KG)
        known += [] if bias is None else [bias]
    return bias_prior(known, LOAD_KG)


def errors_of(trip: SimulatedTrip, seen: Observation, first_s: float = FIRST_S) -> Errors:
    """Return how far an observation is from the truth."""
    t = seen.columns["t_s"]
    early = (t > 5.0) & (t < first_s)
    pitch, thrust = (
        seen.columns[name][early] - np.interp(t[early], trip.truth["t_s"], trip.truth[name])
        for name in ("pitch_rad", "thrust_n")
    )
    grid = CellGrid()
    sums = accumulate(operating_points(seen, decode_image(trip.image).recordings[0], trip.vehicle), grid)
    eta = map_error(build_map(sums, grid, trip.vehicle), trip.engine.map_efficiency).rmse
    return Errors(float(np.degrees(np.sqrt(np.mean(pitch**2)))), float(np.sqrt(np.mean(thrust**2))), float(eta))


def measure() -> list[Figure]:
    """Return the errors of a long and a short trip with and without the car's first three, over three cars."""
    pairs: dict[str, list[tuple[Errors, Errors]]] = {}
    for seed in CARS:
        note(f"driving car {seed}")
        driven = trips_of_car(seed, DURATIONS_S)
        for name, smooth, without in RUNS:
            prior = prior_of(driven[:EARLIER], without)
            for last, duration_s in zip(driven[EARLIER:], DURATIONS_S[EARLIER:], strict=True):
                ours, alone = (errors_of(last, look(last, one, smooth, without)) for one in (prior, None))
                pairs.setdefault(f"{duration_s / 60:.0f} min, {name}", []).append((ours, alone))
    return [figure for name, found in pairs.items() for figure in _figures(name, found)]


def _figures(name: str, found: list[tuple[Errors, Errors]]) -> list[Figure]:
    figures = []
    first = f"first {FIRST_S / 60:.0f} min"
    for part, where, unit, goal in (
        ("pitch_deg", f"{first}, pitch", "°", "lower"),
        ("thrust_n", f"{first}, thrust", "N", "lower"),
        ("eta", "map", "1", "not higher"),
    ):
        ours, alone = (float(np.sqrt(np.mean([getattr(pair[side], part) ** 2 for pair in found]))) for side in (0, 1))
        figures.append(Figure(f"{name}: {where}", ours, unit, alone, "from nothing", goal=goal))
    return figures
