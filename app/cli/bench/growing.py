"""A car's map with a million operating points takes up a new hour, against making it from all points anew."""

from __future__ import annotations

import json
from dataclasses import replace
from math import pi

import numpy as np

from app.cli.bench.figure import Figure, best_seconds
from app.cli.bench.truth import observed_points
from app.cli.bench.virtual_hour import virtual_hour
from app.maps.service import added_by, cells_changed, grown
from app.science.engine.document import map_document
from app.science.engine.points import OperatingPoints
from app.science.vehicle.xml import read_vehicle

POINTS = 1_000_000
SPREAD = 0.03
NEW = "new"


def measure() -> list[Figure]:
    """Return the time from an hour's operating points to the car's new map, its document and what changed with it."""
    trip = virtual_hour()
    vehicle, hour = read_vehicle(trip.car_xml), observed_points(trip)
    rng = np.random.default_rng(1)
    earlier = {f"trip {number}": another(hour, rng) for number in range(-(-POINTS // len(hour)))}
    kept = {name: added_by(points) for name, points in earlier.items()}
    before = grown(kept, (), vehicle).cells

    def document(packed: dict[str, bytes]) -> bytes:
        found = grown(packed, (), vehicle)
        changes = cells_changed(before, found.cells)
        return json.dumps(map_document(found.map, {"changes": changes})).encode()

    incremental = best_seconds(lambda: document(kept | {NEW: added_by(hour)}))
    anew = {**earlier, NEW: hour}
    whole = best_seconds(lambda: document({name: added_by(points) for name, points in anew.items()}), repeats=2)
    name = (
        f"a map of {len(earlier)} trips with {sum(map(len, earlier.values()))} points takes up an hour of {len(hour)}"
    )
    return [Figure(name, 1e3 * incremental, "ms", 1e3 * whole, "from all points, read already", goal="at most 50 ms")]


def another(points: OperatingPoints, rng: np.random.Generator) -> OperatingPoints:
    """Return a trip like this one at somewhat other engine speeds and torques."""
    speed, torque, efficiency = (1.0 + SPREAD * rng.standard_normal((3, len(points)))) * (
        points.engine_speed_rpm, points.torque_nm, points.efficiency,
    )  # fmt: skip
    power = speed * torque * pi / 30.0
    return replace(
        points,
        engine_speed_rpm=speed,
        torque_nm=torque,
        power_w=power,
        fuel_power_w=power / efficiency,
        efficiency=efficiency,
    )
