"""What of a drive is drawn over time or distance: each panel with its lines, in the units people read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.figures.drive_documents import DrawnDrive, Over
from app.science.arrays import FloatArray
from app.science.optimal.fuel_checks import full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, BallAndWheel, PolynomialEngine, Route

KMH = 3.6

Role = Literal["drive", "limit", "other", "rival"]


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a panel.

    Attributes
    ----------
    name : str
    x, y : array, shape (n,)
        Seconds or kilometres, and what is shown; NaN leaves a gap.
    role : {"drive", "limit", "other", "rival"}
        The drive itself, what it may not pass, another drive, and what else could have been done.
    sd : array, shape (n,), optional
        Standard deviations, drawn as bands.
    """

    name: str
    x: FloatArray
    y: FloatArray
    role: Role = "drive"
    sd: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel with its name, unit and lines.

    Attributes
    ----------
    label, unit : str
    decimals : int
    lines : tuple of Line
    stepped : bool
        Whole numbers that change in jumps.
    span : (lowest, highest) or None
        What is shown; None shows all of the drive.
    """

    label: str
    unit: str
    decimals: int
    lines: tuple[Line, ...]
    stepped: bool = False
    span: tuple[float, float] | None = None


Maker = Callable[[DrawnDrive, Over], tuple[Panel, ...]]


def along(drive: DrawnDrive, over: Over) -> FloatArray:
    """Return what the lines are drawn over: s or km."""
    if over == "distance" and drive.has("distance_m"):
        return drive.column("distance_m") / 1000.0
    return drive.column("t_s")


def _plain(drive: DrawnDrive, over: Over, name: str, label: str, unit: str, factor: float, decimals: int) -> Panel:
    line = Line(label, along(drive, over), factor * drive.column(name))
    return Panel(label, unit, decimals, (line,))


def speed(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return the speed, on a road below its limits."""
    panel = _plain(drive, over, "speed_mps", "Speed", "km/h", KMH, 2)
    if not isinstance(drive.problem, Route):
        return (panel,)
    road = drive.problem.road
    place = np.array(road.distance_m) - road.distance_m[0]
    here = np.clip(np.searchsorted(place, drive.column("distance_m"), side="right") - 1, 0, len(place) - 1)
    limit = Line("Speed limit", along(drive, over), KMH * np.array(road.speed_limit_mps)[here], "limit")
    return (Panel(panel.label, panel.unit, panel.decimals, (limit, *panel.lines)),)


def elevation(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return the height of the road; nothing on the level."""
    if not isinstance(drive.problem, Route):
        return ()
    road = drive.problem.road
    place = np.array(road.distance_m) - road.distance_m[0]
    height = np.array(road.elevation_m)
    if np.ptp(height) == 0.0:
        return ()
    if over == "distance":
        return (Panel("Elevation", "m", 1, (Line("Elevation", place / 1000.0, height),)),)
    return (
        Panel(
            "Elevation",
            "m",
            1,
            (Line("Elevation", along(drive, over), np.interp(drive.column("distance_m"), place, height)),),
        ),
    )


def gears(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return the gear, where there are any, and the engine speed."""
    found: list[Panel] = []
    gear = drive.column("gear")
    if (gear > 0).any():
        found.append(Panel("Gear", "", 0, (Line("Gear", along(drive, over), gear),), stepped=True))
    if drive.has("engine_speed_radps"):
        found.append(_plain(drive, over, "engine_speed_radps", "Engine speed", "rpm", 1.0 / RADPS_PER_RPM, 0))
    return tuple(found)


def torque(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return torque below full load, fuel power, and the brakes where they are used."""
    x, found = along(drive, over), list[Panel]()
    engine = None if isinstance(drive.problem, BallAndWheel) else drive.problem.engine
    if drive.has("torque_nm"):
        line = Line("Torque", x, drive.column("torque_nm"))
        limits: tuple[Line, ...] = ()
        if isinstance(engine, PolynomialEngine):
            rpm = drive.column("engine_speed_radps") / RADPS_PER_RPM
            top = np.where(np.isfinite(line.y), full_load_nm(engine, rpm), np.nan)
            limits = (Line("Full load", x, top, "limit"),)
        found.append(Panel("Torque", "Nm", 1, (*limits, line)))
    found.append(_plain(drive, over, "fuel_power_w", "Fuel power", "kW", 1e-3, 2))
    if drive.has("brake_n") and drive.column("brake_n").max() > 0.0:
        found.append(_plain(drive, over, "brake_n", "Brakes", "kN", 1e-3, 3))
    return tuple(found)


def costates(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return what another m/s, and another metre, is worth along the drive."""
    x = along(drive, over)
    shown: Mapping[str, tuple[str, str, float, int]] = {
        "speed": ("Costate of speed", "kJ per m/s", 1e-3, 3),
        "distance": ("Costate of distance", "kJ/km", 1.0, 2),
        "lambda_1": ("Costate of x₁", "", 1.0, 4),
        "lambda_2": ("Costate of x₂", "", 1.0, 4),
    }
    found = []
    for name, (label, unit, factor, decimals) in shown.items():
        values = drive.costate(name)
        if values is not None:
            found.append(Panel(label, unit, decimals, (Line(label, x, factor * values),)))
    return tuple(found)


def ball(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return the states and the control of the ball on the wheel."""
    names = {"x1": "x₁", "x2": "x₂", "u": "u"}
    return tuple(_plain(drive, over, name, label, "", 1.0, 4) for name, label in names.items())
