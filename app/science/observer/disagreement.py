"""Where two sensors of one trip tell different stories of the same thing, in words."""

from __future__ import annotations

import numpy as np

from app.science.logger.recording import Recording, Series
from app.science.vehicle.model import Vehicle

WORTH_SAYING = 0.02
SHORTEST_M = 1000.0


def distance_disagreement(recording: Recording, vehicle: Vehicle, distance_m: float) -> tuple[str, ...]:
    """Compare the distance by the car's own speed with the receiver's over the time that both cover.

    Parameters
    ----------
    recording : Recording
    vehicle : Vehicle
    distance_m : float
        What the observer makes of both, over the whole trip.

    Returns
    -------
    tuple of str
        One sentence where they differ by more than 2 %, else nothing.
    """
    receiver = recording.get("gnss_speed_mps")
    ticks, speed = recording.get("vss_tick"), recording.get("speed_mps")
    own = ticks if ticks is not None else speed
    if receiver is None or own is None or min(len(receiver), len(own)) < 2:
        return ()
    begin, end = max(receiver.t_s[0], own.t_s[0]), min(receiver.t_s[-1], own.t_s[-1])
    by_receiver = _travelled(receiver, begin, end)
    if ticks is not None:
        by_car = float(ticks.value[(ticks.t_s >= begin) & (ticks.t_s <= end)].sum()) * vehicle.vss_m_per_tick
    else:
        by_car = _travelled(own, begin, end) * vehicle.speed_scale
    if by_receiver < SHORTEST_M or abs(by_car / by_receiver - 1.0) <= WORTH_SAYING:
        return ()
    spacing = float(np.median(np.diff(own.t_s)))
    why = (
        f"the car's speed came only every {spacing:.0f} s"
        if ticks is None and spacing > 2.0
        else "look at the metres per tick or the speed's scale in the car's file"
    )
    return (
        f"Distances disagree: {by_car / 1000:.1f} km by the car's own speed, {by_receiver / 1000:.1f} km by the "
        f"receiver over the same time, {distance_m / 1000:.1f} km by the observer over the whole trip; {why}.",
    )


def _travelled(speed: Series, begin_s: float, end_s: float) -> float:
    inside = (speed.t_s >= begin_s) & (speed.t_s <= end_s)
    return float(np.trapezoid(speed.value[inside], speed.t_s[inside])) if inside.any() else 0.0
