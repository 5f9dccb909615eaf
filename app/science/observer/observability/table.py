"""The thesis' table of sensor losses (Sebesta 2010, 3.1.2.1), computed for a car."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.science.observer.observability.losses import SENSORS, SensorTest, Told, When

THESIS_CAR = (
    "vss", "acc_i", "acc_j", "acc_k", "gps_north", "gps_east", "gps_altitude", "dem_altitude", "engine_angle",
    "fuel_energy",
)  # fmt: skip
"""What the thesis' car measures (1.15), but for road headings, which our elevation tables don't have."""


SHORT = ("x", "v", "F", "ψ", "θ", "N", "E", "D", "S_j", "S_k", "E_in", "P_in", "θ_e", "ω_e", "b_i", "b_j", "b_k")
SIGN: dict[When, str] = {"always": "●", "changing": "◐", "never": "○"}


@dataclass(frozen=True, slots=True)
class Case:
    """A set of sensors.

    Attributes
    ----------
    name : str
    lost : tuple of str
        Names of `SENSORS`, or of single measurements.
    added : tuple of str
        What is known instead.
    """

    name: str
    lost: tuple[str, ...] = ()
    added: tuple[str, ...] = ()


CASES = (
    Case("all sensors"),
    Case("no satellites", ("gps",)),
    Case("no satellites, no road heights", ("gps", "dem")),
    Case("satellites without height, no road heights", ("gps_altitude", "dem")),
    Case("no satellites, no road heights, but a compass", ("gps", "dem"), ("heading",)),
    Case("no satellites, no road heights, but a yaw rate", ("gps", "dem"), ("yaw_rate",)),
    Case("no satellites, no road heights, but a pitch", ("gps", "dem"), ("pitch",)),
    Case("no road heights", ("dem",)),
    Case("no accelerometer", ("acc",)),
    Case("two-axis accelerometer", ("acc_k",)),
    Case("no wheel ticks", ("vss",)),
    Case("no wheel ticks, no satellites", ("vss", "gps")),
    Case("no engine speed", ("engine_angle",)),
    Case("no engine speed, but the gear", ("engine_angle",), ("gear",)),
    Case("no fuel flow", ("fuel_energy",)),
    Case("satellites and injectors alone", ("vss", "acc", "dem")),
    Case("wheel ticks and injectors alone", ("acc", "gps", "dem")),
)


def loss_table(test: SensorTest) -> list[tuple[Case, Told]]:
    """Return what each of `CASES` tells of the 17 states."""
    return [(case, test.told(measurements_of(case))) for case in CASES]


def table_text(rows: Sequence[tuple[Case, Told]]) -> str:
    """Return the table as Markdown; each cell has a sign for the moving car and one for the standing."""
    width = max(len(case.name) for case, _ in rows)
    lines = [_line("sensors".ljust(width), SHORT), _line("-" * width, [":--:"] * len(SHORT))]
    return "\n".join([*lines, *(_line(case.name.ljust(width), _signs(told)) for case, told in rows)])


def _line(first: str, cells: Sequence[str]) -> str:
    return f"| {first} | {' | '.join(cell.ljust(4) for cell in cells)} |"


def _signs(told: Told) -> list[str]:
    return [SIGN[when] + ("●" if rest else "○") for when, rest in zip(told.moving, told.standing, strict=True)]


def measurements_of(case: Case) -> list[str]:
    """Return the measurements that a case leaves."""
    lost = {name for sensor in case.lost for name in SENSORS.get(sensor, (sensor,))}
    return [name for name in (*THESIS_CAR, *case.added) if name not in lost]
