"""What is said of a change: its name, how large it is, and what to look at."""

from __future__ import annotations

from app.science.health.result import Quantity

TITLES: dict[Quantity, str] = {
    "rolling_resistance": "Rolling resistance",
    "mass": "Mass",
    "drag": "Air drag",
    "efficiency": "Engine efficiency",
}
UNITS: dict[Quantity, str] = {"rolling_resistance": "%", "mass": "kg", "drag": "%", "efficiency": "%"}
"""Of a change; a percent is one of the car file's value."""

ADVICE: dict[tuple[Quantity, bool], str] = {
    ("rolling_resistance", True): (
        "Check the tyre pressures first, then whether a brake drags and whether the wheels are aligned. Winter tyres, "
        "and wet or snowy roads while they last, do the same."
    ),
    ("rolling_resistance", False): (
        "Other tyres, higher pressures or warmer weather do this; nothing needs repair. If it stays, say that this is "
        "the car's new usual."
    ),
    ("mass", True): (
        "Look at what is carried: passengers or load. If it stays, give the car its new load or say that this is its "
        "new usual."
    ),
    ("mass", False): (
        "Less is carried than while the usual was learnt; nothing needs repair. If it stays, give the car its new load "
        "or say that this is its new usual."
    ),
    ("drag", True): (
        "Look for a roof box or rack, a trailer, open windows or a loose panel underneath. A lasting headwind does the "
        "same."
    ),
    ("drag", False): (
        "Something that stood in the wind is gone, such as a roof box or rack, or the wind came from behind; nothing "
        "needs repair."
    ),
    ("efficiency", True): (
        "The engine gives more for the fuel that was counted: another fuel, or injectors that deliver more than they "
        "are thought to. Compare with the litres at the pump and check the injectors for leaks."
    ),
    ("efficiency", False): (
        "Check the air filter, the injectors, the spark plugs and whether the engine gets warm (thermostat). Poor or "
        "another fuel does the same; compare with the litres at the pump."
    ),
}
"""By quantity and whether it rose."""


def trips_of(count: int) -> str:
    """Return "1 trip" or "3 trips"."""
    return f"{count} trip" if count == 1 else f"{count} trips"


def size(quantity: Quantity, change: float) -> str:
    """Return the size of a change with its unit and direction: "18 % above", "140 kg below"."""
    decimals = 1 if quantity == "efficiency" else 0
    return f"{abs(change):.{decimals}f} {UNITS[quantity]} {'above' if change > 0.0 else 'below'}"


def open_words(quantity: Quantity, change: float, trips: int) -> str:
    """Say how large an open change is and for how long it is there."""
    return f"{TITLES[quantity]} {size(quantity, change)} its usual, since {trips_of(trips)}"


def cleared_words(quantity: Quantity, change: float, trips: int) -> str:
    """Say what a change was that is over."""
    return f"{TITLES[quantity]} was {size(quantity, change)} its usual for {trips_of(trips)}, and is back"


def advice(quantity: Quantity, change: float, other: Quantity | None, chance_of_other: float) -> str:
    """Say what to look at, and what else it could be."""
    told = ADVICE[quantity, change > 0.0]
    if other is None:
        return told
    return f"{told} It could also be {TITLES[other].lower()} (probability {100.0 * chance_of_other:.0f} %)."


def usual_words(quantity: Quantity, change: float, sd: float, trips: int) -> str:
    """Say that a quantity is as usual."""
    decimals = 1 if quantity == "efficiency" else 0
    number = f"{change:+.{decimals}f}".replace("-", "−")
    return f"As usual: {number} ± {sd:.{decimals}f} {UNITS[quantity]} over the last {trips_of(trips)}."


def standing(is_open: list[str], watched: int) -> str:
    """Say how a car stands, given the words of its open alerts and how many trips were watched."""
    if is_open:
        return ". ".join(is_open) + "."
    if not watched:
        return "Its usual is known now; the next trips are held against it."
    return f"All as usual, {trips_of(watched)} watched."
