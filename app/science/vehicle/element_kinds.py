"""Kinds of values that occur below ``<ponthy_config>`` more than once, each as a row of the table of elements."""

from __future__ import annotations

from math import pi

from app.science.vehicle import quantities as q
from app.science.vehicle.field import Field

GEARS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def text(path: str, target: str, label: str, help_text: str) -> Field:
    """A value in words."""
    return Field(path, label, help_text, target)


def number(
    path: str,
    target: str,
    label: str,
    quantity: q.Quantity,
    limits: tuple[float, float],
    usual: tuple[float, float] | None,
    help_text: str,
    si: float = 1.0,
    follows: str = "",
) -> Field:
    """A number with its unit and its limits: those beyond which it is refused, and those usually met."""
    return Field(path, label, help_text, target, "number", quantity, si, limits[0], limits[1], usual, follows=follows)


def rating(
    name: str, target: str, quantity: q.Quantity, limits: tuple[float, float], example: str, si: float = 1.0
) -> Field:
    """A largest value and the engine speed it is reached at."""
    help_text = f"With the engine speed it is reached at: {example}."
    label = f"Largest {name}"
    path = f"engine/{name}@{name}"
    return Field(path, label, help_text, target, "text", quantity, si, limits[0], limits[1], form="rating")


def gear(index: int) -> Field:
    """The ratio of a gear, counted from zero."""
    ordinal = ("1st", "2nd", "3rd")[index] if index < 3 else f"{index + 1}th"
    return number(
        f"transmission/{GEARS[index]}@gear",
        f"gear_ratios.{index}",
        f"{ordinal} gear",
        q.RATIO,
        (0.1, 100.0),
        (1.5, 40.0),
        "Turns of the engine per turn of the wheel, final drive included. Empty: there is no such gear.",
    )


def angle(axis: str, symbol: str) -> Field:
    """An angle of the sensor about one of its axes."""
    return number(
        f"accelerometer/calibration/{axis}@{symbol}",
        f"mounting.{axis}_rad",
        f"Mounting {axis}",
        q.ANGLE,
        (-2.0 * pi, 2.0 * pi),
        None,
        "Turns the sensor's axes into the car's (forward, right, down). Degrees may be given as 3.5°.",
    )
