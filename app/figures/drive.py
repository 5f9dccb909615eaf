"""The figures of a drive by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, get_args

from app.figures import drive_panels
from app.figures.drive_documents import DrawnDrive, Over
from app.figures.drive_front import front_figure
from app.figures.drive_hamiltonian import hamiltonian
from app.figures.drive_panels import Line, Maker, Panel
from app.figures.drive_path import path_figure
from app.figures.drive_rivals import competitors_figure, methods_figure
from app.figures.drive_stack import panels_figure
from app.figures.drive_synthesis import synthesis_figure
from app.figures.theme import LIGHT, Json, Theme
from app.science.optimal.problem import BallAndWheel

FigureName = Literal[
    "stack",
    "speed",
    "gears",
    "torque",
    "costates",
    "hamiltonian",
    "road",
    "path",
    "competitors",
    "methods",
    "front",
    "synthesis",
]
NAMES: tuple[FigureName, ...] = get_args(FigureName)

STACKS: dict[str, tuple[Maker, ...]] = {
    "speed": (drive_panels.speed,),
    "gears": (drive_panels.gears,),
    "torque": (drive_panels.torque,),
    "costates": (drive_panels.costates,),
    "hamiltonian": (hamiltonian,),
    "road": (drive_panels.speed, drive_panels.elevation),
    "stack": (
        drive_panels.speed,
        drive_panels.elevation,
        drive_panels.gears,
        drive_panels.torque,
        drive_panels.costates,
    ),
}
BALL_STACKS: dict[str, tuple[Maker, ...]] = {
    "stack": (drive_panels.ball, drive_panels.costates),
    "costates": (drive_panels.costates,),
}
SINGLE: dict[str, Callable[[DrawnDrive, Theme], Json]] = {
    "competitors": competitors_figure,
    "front": front_figure,
    "methods": methods_figure,
    "synthesis": synthesis_figure,
}


def drive_figure(
    name: FigureName, drive: DrawnDrive, *, over: Over = "time", other: DrawnDrive | None = None, theme: Theme = LIGHT
) -> Json:
    """Draw one figure of a drive.

    Parameters
    ----------
    name : FigureName
    drive : DrawnDrive
    over : {"time", "distance"}
        What panels are drawn over.
    other : DrawnDrive, optional
        Another drive that is laid over this one.
    theme : Theme
    """
    if name == "path":
        return path_figure(drive, other, theme)
    if name in SINGLE:
        return SINGLE[name](drive, theme)
    over = "distance" if name == "road" else over
    return panels_figure(_panels(name, drive, over, other), theme, f"drive-{name}-{over}", _across(drive, over))


def _across(drive: DrawnDrive, over: Over) -> str:
    return "Distance, km" if over == "distance" and drive.has("distance_m") else "Time, s"


def _panels(name: str, drive: DrawnDrive, over: Over, other: DrawnDrive | None) -> list[Panel]:
    stacks = BALL_STACKS if isinstance(drive.problem, BallAndWheel) else STACKS
    panels = [panel for maker in stacks.get(name, ()) for panel in maker(drive, over)]
    if other is None:
        return panels
    beside = {panel.label: panel for panel in _panels(name, other, over, None)}
    return [_overlaid(panel, beside.get(panel.label), drive.name, other.name) for panel in panels]


def _overlaid(panel: Panel, beside: Panel | None, name: str, other: str) -> Panel:
    """Lay another drive's line into a panel, both under their drives' names."""
    own = tuple(replace(line, name=name) if line.role == "drive" else line for line in panel.lines)
    laid: tuple[Line, ...] = ()
    if beside is not None:
        laid = tuple(replace(line, name=other, role="other") for line in beside.lines if line.role == "drive")
    return replace(panel, lines=own + laid)
