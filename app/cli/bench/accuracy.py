"""How close the observer comes to known truth on virtual hours, beside the thesis' own values in the same run.

The seeds here were never used for tuning; the tuning was done with seeds 101 and 102.
"""

from __future__ import annotations

from app.cli.bench.figure import Figure
from app.cli.bench.truth import observed_errors
from app.cli.output import note
from app.science.observer.tuning import DEFAULT, THESIS_2010
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

FRESH_SEEDS = (9101, 9102, 9103)
STATES = (
    ("speed_mps", "speed", "m/s", "at most 0.03"),
    ("pitch_rad", "pitch", "°", "at most 0.25"),
    ("thrust_n", "thrust while propelling", "N", "at most 85"),
)


def measure() -> list[Figure]:
    """Return errors and coverage, smoothed, with GPS and elevation and with GPS alone, for every fresh seed."""
    figures: list[Figure] = []
    for seed in FRESH_SEEDS:
        note(f"simulating and observing an hour with seed {seed}")
        trip = simulate(Simulation(duration_s=3600.0, seed=seed))
        for label, without, goal in (
            ("GPS + elevation", frozenset[str](), "at most 0.010"),
            ("GPS only", frozenset({"dem"}), "at most 0.012"),
        ):
            ours, thesis = (observed_errors(trip, tuning=tuning, without=without) for tuning in (DEFAULT, THESIS_2010))
            figures += _figures(f"seed {seed}, {label}", ours, thesis, goal)
    return figures


def _figures(where: str, ours: dict[str, float], thesis: dict[str, float], map_goal: str) -> list[Figure]:
    rows = []
    for column, name, unit, goal in STATES:
        against = "thesis-2010"
        rows.append(Figure(f"{where}: {name}, RMSE", ours[column], unit, thesis[column], against, goal=goal))
        inside = f"{column} inside"
        rows.append(
            Figure(
                f"{where}: {name}, truth inside two sigma", ours[inside], "%", thesis[inside], against, "higher",
                goal="90 to 99 %",
            )
        )  # fmt: skip
    rows.append(Figure(f"{where}: map, RMSE of η", ours["map"], "1", thesis["map"], "thesis-2010", goal=map_goal))
    rows.append(
        Figure(
            f"{where}: trusted cells", ours["cells"], "1", thesis["cells"], "thesis-2010", "higher", goal="at least 550"
        )
    )
    return rows
