"""A drive as a method hands it over, before anybody judges it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import ScienceError
from app.science.optimal.accelerate.kernels import GEARS, NEUTRAL, DriveNumbers
from app.science.optimal.answer import Trajectory
from app.science.optimal.methods.model import Wheels, resistance_n


class MethodFailed(ScienceError):  # noqa: N818 - reads as the condition it names
    """A method applies to the problem but found no drive; the message says what it met and what else to try."""

    code = "method-failed"


@dataclass(frozen=True, slots=True)
class Arc:
    """A part of a drive in one gear, each array of shape (n,).

    Attributes
    ----------
    gear : int
        From 0, as in the drive's numbers; −1 is neutral.
    t_s, distance_m : array
        Since the drive's start.
    speed_mps : array
    wheels : Wheels
    brake_n : array
    costate : array or None
        λ_v, J s/m, where the method has one.
    """

    gear: int
    t_s: FloatArray
    distance_m: FloatArray
    speed_mps: FloatArray
    wheels: Wheels
    brake_n: FloatArray
    costate: FloatArray | None = None

    def later(self, seconds: float, metres: float) -> Arc:
        """Return the same part of a drive, later and further on."""
        return replace(self, t_s=self.t_s + seconds, distance_m=self.distance_m + metres)


@dataclass(frozen=True, slots=True)
class Found:
    """A drive with what its method knows about it.

    Attributes
    ----------
    trajectory : Trajectory
    force_n : array, shape (n,)
        At the wheels.
    fuel_j : float
        By the method's own quadrature.
    costate : array, shape (n,), or None
        λ_v, J s/m, where the method has one.
    mu_w : float or None
        Price of a second, where the method has one.
    notes : tuple of str
    more : mapping
        Further numbers by name.
    """

    trajectory: Trajectory
    force_n: FloatArray
    fuel_j: float
    costate: FloatArray | None = None
    mu_w: float | None = None
    notes: tuple[str, ...] = ()
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def time_s(self) -> float:
        """Time, s."""
        return float(self.trajectory.t_s[-1] - self.trajectory.t_s[0])

    @property
    def gears(self) -> tuple[int, ...]:
        """One gear for each phase, as people count."""
        gear = self.trajectory.gear
        return tuple(int(g) for g in gear[np.flatnonzero(np.diff(gear, prepend=gear[0] - 1))])

    @property
    def switch_speeds_mps(self) -> tuple[float, ...]:
        """Return the speed at each change of gear."""
        after = np.flatnonzero(np.diff(self.trajectory.gear)) + 1
        return tuple(float(v) for v in self.trajectory.speed_mps[after])


def joined(
    drive: DriveNumbers,
    arcs: Sequence[Arc],
    fuel_j: float,
    *,
    mu_w: float | None = None,
    notes: tuple[str, ...] = (),
    more: Mapping[str, Any] | None = None,
) -> Found:
    """Return arcs, one after the other, as one drive."""

    def column(name: str) -> FloatArray:
        return np.concatenate([getattr(arc, name) for arc in arcs])

    def of_wheels(name: str) -> FloatArray:
        return np.concatenate([np.real(getattr(arc.wheels, name)) for arc in arcs])

    shown = [np.full(len(arc.t_s), shown_gear(drive, arc.gear), np.int64) for arc in arcs]
    trajectory = Trajectory(
        t_s=column("t_s"),
        distance_m=column("distance_m"),
        speed_mps=column("speed_mps"),
        gear=np.concatenate(shown),
        engine_speed_radps=of_wheels("engine_radps"),
        torque_nm=of_wheels("torque_nm"),
        fuel_power_w=of_wheels("fuel_w"),
        brake_n=column("brake_n"),
    )
    costates = [arc.costate for arc in arcs]
    known = [one for one in costates if one is not None]
    costate = np.concatenate(known) if len(known) == len(costates) else None
    return Found(trajectory, of_wheels("force_n"), fuel_j, costate, mu_w, notes, more or {})


def shown_gear(drive: DriveNumbers, gear: int) -> int:
    """Return a gear as people count: from 1, 0 for neutral and for drives without gears."""
    return gear + 1 if drive.kind == GEARS and gear != NEUTRAL else 0


def acceleration_mps2(drive: DriveNumbers, found: Found) -> FloatArray:
    """Return v̇ along a drive."""
    against = resistance_n(drive, found.trajectory.speed_mps) + found.trajectory.brake_n
    return np.asarray((found.force_n - against) / drive.accelerated_kg)
