"""The Hamiltonian along a drive, and the largest that any other gear allows."""

from __future__ import annotations

import numpy as np

from app.figures.decimate import even_indices
from app.figures.drive_documents import DrawnDrive, Over
from app.figures.drive_panels import Line, Panel, along
from app.science.arrays import FloatArray, IntArray
from app.science.optimal.alternatives import Moments, best_of_gears_w, hamiltonian_w
from app.science.optimal.problem import BallAndWheel, Road, Route

MOST_MOMENTS = 600
BELOW = 0.4
ABOVE = 0.06
LEAST_SHOWN = 1e-6
ROOM = 1.2


def hamiltonian(drive: DrawnDrive, over: Over) -> tuple[Panel, ...]:
    """Return H − μ of the drive, which an extremal keeps at 0, and of the best control in every gear, kW.

    A control with H above μ would be better; what a change of gear is charged may keep it from being taken.
    """
    problem = drive.problem
    if isinstance(problem, BallAndWheel) or drive.costate("speed") is None:
        return ()
    x, m = along(drive, over), _moments(drive)
    own = hamiltonian_w(problem, m) - drive.multiplier_w
    kept = even_indices(len(x), MOST_MOMENTS)
    few = Moments(*(getattr(m, name)[kept] for name in m.__slots__))
    best = {name: h - drive.multiplier_w for name, h in best_of_gears_w(problem, few).items()}
    peak = float(np.nanmax(m.fuel_power_w)) / 1000.0 or 1.0
    rivals = tuple(
        Line(f"best in {name}" if "gear" in name else name, x[kept], h / 1000.0, "rival") for name, h in best.items()
    )
    return (
        Panel("H − μ of this drive", "W", 6, (Line("H − μ", x, own),), span=_around(own, 1000.0 * peak)),
        Panel(
            "H − μ, every gear at its best" if len(rivals) > 1 else "H − μ, the best of all controls",
            "kW",
            3,
            (*rivals, Line("this drive", x, own / 1000.0)),
            span=(-BELOW * peak, ABOVE * peak),
        ),
    )


def _around(own: FloatArray, peak_w: float) -> tuple[float, float]:
    """Return what is shown of H − μ: a millionth of the largest power at least, so that rounding stays flat."""
    reach = max(float(np.nanmax(np.abs(own), initial=0.0)), LEAST_SHOWN * peak_w)
    return -ROOM * reach, ROOM * reach


def _moments(drive: DrawnDrive) -> Moments:
    speed, distance = drive.column("speed_mps"), drive.column("distance_m")
    lambda_v, lambda_x = drive.costate("speed"), drive.costate("distance")
    flat = np.zeros(len(speed))
    return Moments(
        speed_mps=speed,
        slope=_slope(drive.problem.road, distance) if isinstance(drive.problem, Route) else flat,
        gear=_whole(drive.column("gear")),
        engine_speed_radps=drive.column("engine_speed_radps"),
        torque_nm=drive.column("torque_nm"),
        fuel_power_w=drive.column("fuel_power_w"),
        brake_n=drive.column("brake_n"),
        lambda_v=flat if lambda_v is None else lambda_v,
        lambda_x=flat if lambda_x is None else lambda_x,
    )


def _whole(values: FloatArray) -> IntArray:
    return values.astype(np.int64)


def _slope(road: Road, distance_m: FloatArray) -> FloatArray:
    """Return dz/ds of the piece of road at each point; at a corner that of the piece that begins there."""
    place = np.array(road.distance_m) - road.distance_m[0]
    slopes = np.diff(road.elevation_m) / np.diff(place)
    return np.asarray(slopes[np.clip(np.searchsorted(place, distance_m, side="right") - 1, 0, len(slopes) - 1)])
