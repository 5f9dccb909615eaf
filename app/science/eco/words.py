"""What a score rests on, and what a reader should know of it."""

from __future__ import annotations

from collections.abc import Sequence

from app.science.eco.best import Car
from app.science.eco.doubt import LoadDoubts
from app.science.eco.fuel_model import FuelModel
from app.science.eco.known_engine import KnownEngine
from app.science.eco.result import Section
from app.science.eco.sections import Compared
from app.science.vehicle.model import Vehicle

ROLLS_IN_GEAR = "The best drive rolls with a gear in and brakes no harder than the driver did."
LARGE_MISS = 0.1
LITTLE_SCORED = 0.5
ROUGH_FORMULA = 0.1


def engine_words(engine: KnownEngine, vehicle: Vehicle, car: Car) -> tuple[str, ...]:
    """Return what the engine's model rests on where it isn't the car's map with this trip's fuel, the gravest first."""
    said = []
    if engine.source == "ordinary":
        said.append(
            "This trip measured no fuel and the car's map carries no formula: an ordinary engine stands in, the mean "
            "of seven measured ones. Litres are that engine's; trust the percentage, within its deviation."
        )
    elif engine.source == "trip":
        said.append(
            "The car's map has too few cells for a formula: one was fitted to this trip's own fuel, starting from "
            "seven measured engines. More driving makes the score surer."
        )
    elif not engine.trip.fuel_known:
        said.append("This trip measured no fuel; all litres are those of the car's map.")
    if engine.ordinary is not None and engine.ordinary.litres_share > 0.0:
        said.append(
            f"The car's file doesn't say its displacement; {engine.ordinary.litres:.1f} l were taken, within "
            f"{100.0 * engine.ordinary.litres_share:.0f} %, by the car's mass."
        )
    if not vehicle.gear_ratios:
        ratios = ", ".join(f"{ratio:.2f}" for ratio in car.ratios)
        said.append(
            f"The car's file has no gear ratios; the drive shows these: {ratios} (engine to wheel). A gear that was "
            "used for a few seconds only may be missing."
        )
    return tuple(said)


FUELS = {
    "map": "the formula of the car's map",
    "trip": "a formula fitted to this trip",
    "ordinary": "the formula of an ordinary engine",
}


def assumptions(car: Car, doubts: LoadDoubts, engine: KnownEngine) -> tuple[str, ...]:
    """Return what was decided for both drives."""
    low, high = car.engine.speed_rpm
    return (
        "The best drive covers the same road from stop to stop, begins and ends each section as fast, and takes no "
        "longer. It stands as long where the driver stood.",
        "It is nowhere faster than the driver was within 300 m; where he was slow for a reason, in a bend, at a "
        "junction or behind others, it is as slow.",
        f"Both drives are charged by one fuel model: {FUELS[engine.source]}"
        + (", corrected by the fuel this trip measured" if engine.trip.fuel_known else "")
        + ". In overrun, and while braking, the fuel is cut.",
        f"The engine runs from {low:.0f} to {high:.0f} rpm, as it did on this trip or in its map, and up to the most "
        "torque it has shown.",
        ("The best drive may roll with the clutch open at idle fuel." if car.freewheels else ROLLS_IN_GEAR)
        + f" The car counts as {car.load.accelerated_mass_kg:.0f} kg in every gear.",
        f"Doubts: mass {100.0 * doubts.mass_share:.0f} %, rolling resistance {100.0 * doubts.rolling_share:.0f} %, "
        f"drag {100.0 * doubts.drag_share:.0f} %, one standard deviation each, and the fuel model's own.",
    )


def warnings(
    model: FuelModel,
    compared: Sequence[Compared],
    results: Sequence[Compared | Section],
    measured_j: float,
    trip_j: float,
) -> tuple[str, ...]:
    """Return what makes a score weak."""
    said = []
    modelled = sum(one.driven.fuel_j for one in compared)
    miss = modelled / measured_j - 1.0
    if abs(miss) > LARGE_MISS:
        word = "above" if miss > 0.0 else "below"
        said.append(
            f"The fuel model is {100.0 * abs(miss):.0f} % {word} what was measured; the car's mass, resistances or map "
            "may be off."
        )
    if model.error_share > ROUGH_FORMULA:
        said.append(
            f"The map's formula misses cells that it was not shown by {100.0 * model.error_share:.0f} % of their "
            "efficiency; more driving at other loads and engine speeds would make the score surer."
        )
    if measured_j < LITTLE_SCORED * trip_j:
        said.append(f"Only {100.0 * measured_j / trip_j:.0f} % of the trip's fuel is in the sections that were scored.")
    left = [one for one in results if isinstance(one, Section)]
    if left:
        lost_j = sum(one.measured_j for one in left)
        what = "1 section is" if len(left) == 1 else f"{len(left)} sections are"
        said.append(f"{what} not scored, with {100.0 * lost_j / trip_j:.1f} % of the fuel: {left[0].reason}")
    return tuple(said)
