"""What one minute of driving tells by its measurements alone, with and without heights, and how long asking takes."""

from __future__ import annotations

import numpy as np

from app.cli.bench.figure import Figure, best_seconds, timed
from app.cli.bench.virtual_hour import virtual_hour
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.observer.observability.car_system import TYPICAL
from app.science.observer.observability.gramian import information_along
from app.science.observer.observe import observe
from app.science.observer.states import State
from app.science.observer.tuning import DEFAULT
from app.science.vehicle.xml import read_vehicle

STATES = (
    (State.THRUST, "thrust", 1.0, "N"),
    (State.PITCH, "pitch", 180.0 / np.pi, "°"),
    (State.BIAS_I, "accelerometer bias forward", 1.0, "m/s²"),
)


def measure() -> list[Figure]:
    """Return what the median minute of a virtual hour leaves open, beside what one knew before."""
    trip = virtual_hour()
    recording, vehicle = decode_image(trip.image).recordings[0], read_vehicle(trip.car_xml)
    elevation = read_elevation(trip.elevation_csv)
    figures: list[Figure] = []
    for label, without in (
        ("GPS + elevation", frozenset[str]()),
        ("GPS only", frozenset({"dem"})),
        ("neither", frozenset({"gps", "dem"})),
    ):
        note(f"asking what each minute tells: {label}")
        seen = observe(recording, vehicle, elevation=elevation, without=without)
        left = np.median(information_along(seen, vehicle, DEFAULT).sd(TYPICAL), axis=0)
        for state, name, factor, unit in STATES:
            words = f"{label}: {name} that a minute leaves open"
            figures.append(Figure(words, factor * left[state], unit, factor * TYPICAL[state], "without sensors"))
    asking = best_seconds(lambda: information_along(seen, vehicle, DEFAULT), 3)
    observing = timed(lambda: observe(recording, vehicle, without=without))
    figures.append(Figure("asking what each minute of an hour tells", asking, "s", observing, "observing the hour"))
    return figures
