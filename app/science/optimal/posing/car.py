"""A car's file and its map as a complete drive problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from app.science.engine.document import read_map_document
from app.science.fields import Fields
from app.science.optimal.from_map import engine_of_map
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine
from app.science.optimal.reading import read_engine
from app.science.vehicle.model import Vehicle

CarKind = Literal["accelerate", "distance", "route"]
SLOWEST_MPS, CREEP = 1.0, 1.001
"""Where no gear sets one, the lowest speed of a route; and how far above a gear's lowest speed a drive begins."""
ROAD, LEAST_POINTS = ("distance_m", "elevation_m", "speed_limit_mps"), 2
BRAKING_MPS2 = 6.0
SHIFT_J = 2000.0
ORDINARY_KMH = (36.0, 100.0)
ORDINARY_M = 1000.0
KMH = 3.6


@dataclass(frozen=True, slots=True)
class Wishes:
    """What a driver wants of the drive; None leaves it to what is ordinary.

    Attributes
    ----------
    from_speed_mps, to_speed_mps : float or None
    max_time_s : float or None
        Of a route: at most; of an acceleration: exactly.
    distance_m : float or None
        Of a ``distance``.
    neutral : bool or None
        Whether rolling in neutral is allowed; ordinarily on a route only, where brakes act in neutral.
    shift_cost_j : float or None
        Ordinarily 2 kJ on a route, which keeps gears from being changed for nothing, and nothing else.
    """

    from_speed_mps: float | None = None
    to_speed_mps: float | None = None
    max_time_s: float | None = None
    distance_m: float | None = None
    neutral: bool | None = None
    shift_cost_j: float | None = None


@dataclass(frozen=True, slots=True)
class PosedProblem:
    """A problem document that can be solved as it is, and what was decided on the way.

    Attributes
    ----------
    problem : dict
    notes : tuple of str
    """

    problem: dict[str, Any]
    notes: tuple[str, ...]


def problem_of_car(
    vehicle: Vehicle,
    map_document: Mapping[str, Any],
    road: Mapping[str, Any] | None = None,
    *,
    kind: CarKind | None = None,
    wishes: Wishes | None = None,
    fit: str = "willans",
    engine: Mapping[str, Any] | None = None,
) -> PosedProblem:
    """Pose a drive for a car.

    Parameters
    ----------
    vehicle : Vehicle
    map_document : mapping
        ``map.json`` of the car.
    road : mapping or None
        The ``road`` of a route.
    kind : str or None
        ``route`` where there is a road, else ``accelerate``.
    wishes : Wishes or None
    fit : {"willans", "phi"}
        The formula that is taken for the map.
    engine : mapping or None
        An engine to take instead of a formula through the map.

    Raises
    ------
    PoseError
        When the car's file has no gears, or a route has no road.
    FitError
        When the map can't carry the formula.
    """
    wanted = wishes or Wishes()
    kind = kind or ("accelerate" if road is None else "route")
    chosen = dict(engine or engine_of_map(map_document, Fields({"map": "", "fit": fit}, "engine")))
    notes = [misfit(chosen, map_document)]
    problem: dict[str, Any] = {
        "kind": kind,
        "vehicle": road_load(vehicle, notes),
        "engine": chosen,
        "transmission": transmission(vehicle, kind, wanted, notes),
    }
    if kind == "distance":
        problem |= {
            "from_speed_mps": _or(wanted.from_speed_mps, ORDINARY_KMH[0] / KMH),
            "distance_m": _or(wanted.distance_m, ORDINARY_M),
        }
        return PosedProblem(problem, tuple(notes))
    lowest, highest = speeds(vehicle, chosen)
    if kind == "accelerate":
        problem |= {
            "from_speed_mps": _or(wanted.from_speed_mps, max(ORDINARY_KMH[0] / KMH, CREEP * lowest)),
            "to_speed_mps": _or(wanted.to_speed_mps, min(ORDINARY_KMH[1] / KMH, highest / CREEP)),
            "time_s": wanted.max_time_s,
        }
        return PosedProblem(problem, tuple(notes))
    if road is None:
        raise PoseError("A route needs a road: distance_m, elevation_m and speed_limit_mps.")
    return PosedProblem(problem | _along(road, wanted, (lowest, highest), vehicle.mass_kg, notes), tuple(notes))


def misfit(engine: Mapping[str, Any], map_document: Mapping[str, Any]) -> str:
    """Say how far the fuel power of an engine is from that of a map, where both are known."""
    found, seen = read_engine(Fields(engine, "engine")), read_map_document(map_document)
    if not isinstance(found, PolynomialEngine):
        return "The engine is known by its power only and can't be compared with the map."
    omega = seen.rpm * RADPS_PER_RPM
    inside = np.isfinite(seen.efficiency) & (seen.efficiency > 0.0)
    inside &= (seen.rpm >= found.speed_rpm[0]) & (seen.rpm <= found.speed_rpm[1])
    inside &= (seen.nm >= found.torque_nm[0]) & (seen.nm <= full_load_nm(found, seen.rpm))
    fuel = omega[inside] * seen.nm[inside] / seen.efficiency[inside]
    off = 100.0 * np.abs(fuel_power_w(found, omega[inside], seen.nm[inside]) / fuel - 1.0)
    weight = np.maximum(seen.n[inside], 1)
    return (
        f"The engine's formula misses the fuel power of {off.size} cells of the map by "
        f"{np.sqrt(np.average(off**2, weights=weight)):.1f} % rms of the time spent there, {off.max():.0f} % at most."
    )


def road_load(vehicle: Vehicle, notes: list[str]) -> dict[str, float]:
    """Return the ``vehicle`` of a problem; a note says which gear's turning masses count."""
    gear = len(vehicle.gear_ratios) // 2 + 1 if vehicle.gear_ratios else 0
    if gear:
        first, last = (vehicle.accelerated_mass_kg(k) for k in (1, len(vehicle.gear_ratios)))
        notes.append(
            f"A problem has one accelerated mass: that of gear {gear}, {vehicle.accelerated_mass_kg(gear):.0f} kg. In "
            f"first gear the car behaves like {first:.0f} kg, in the last like {last:.0f} kg."
        )
    return {
        "mass_kg": vehicle.mass_kg,
        "accelerated_mass_kg": vehicle.accelerated_mass_kg(gear),
        "cd": vehicle.cd,
        "frontal_area_m2": vehicle.frontal_area_m2,
        "crr": vehicle.crr,
        "air_density_kgpm3": vehicle.air_density_kgpm3,
        "gravity_mps2": vehicle.gravity_mps2,
        "wheel_radius_m": vehicle.wheel_radius_m,
    }


def transmission(vehicle: Vehicle, kind: CarKind, wishes: Wishes, notes: list[str]) -> dict[str, Any]:
    """Return the ``transmission`` of a problem; a distance is driven as if the ratio were free."""
    neutral = kind == "route" if wishes.neutral is None else wishes.neutral
    charge = _or(wishes.shift_cost_j, 0.0 if kind == "distance" else SHIFT_J)
    common = {"neutral": neutral, "shift_cost_j": charge}
    if kind == "distance":
        notes.append("A distance is for a free ratio; the car's gears are left out. For gears, pose a route.")
        return {"type": "cvt", **common, "shift_cost_j": 0.0}
    if not vehicle.gear_ratios:
        raise PoseError(
            "The car's file has no gear ratios; fill in its transmission (total ratios, engine to wheel), first gear "
            "first."
        )
    if wishes.shift_cost_j is None and charge:
        notes.append(f"Each change of gear is charged {charge / 1000.0:g} kJ.")
    return {"type": "gears", "ratios": list(vehicle.gear_ratios), **common}


def speeds(vehicle: Vehicle, engine: Mapping[str, Any]) -> tuple[float, float]:
    """Return the lowest speed of first gear and the highest of the last one within the map's engine speeds, m/s."""
    low, high = engine["speed_rpm"]
    ratios = vehicle.gear_ratios
    return (
        low * RADPS_PER_RPM * vehicle.wheel_radius_m / max(ratios),
        high * RADPS_PER_RPM * vehicle.wheel_radius_m / min(ratios),
    )


def _along(
    road: Mapping[str, Any], wishes: Wishes, span_mps: tuple[float, float], mass_kg: float, notes: list[str]
) -> dict[str, Any]:
    """Return the fields of a route: the ends as wanted, or as fast as the road allows there."""
    missing = [name for name in ROAD if not isinstance(road.get(name), list | tuple) or len(road[name]) < LEAST_POINTS]
    if missing:
        names = ", ".join(missing)
        raise PoseError(f"The road lacks {names}: lists of two numbers or more, as ./ponthy road writes them.")
    limits = [float(limit) for limit in road["speed_limit_mps"]]
    lowest = max(CREEP * span_mps[0], SLOWEST_MPS)
    slowest = min(lowest, min(limits))
    if slowest < lowest:
        notes.append(
            f"The road's lowest limit, {KMH * slowest:.1f} km/h, is below what first gear can do, "
            f"{KMH * lowest:.1f} km/h; allow neutral, or raise that limit."
        )
    start, end = (min(limits[k], span_mps[1] / CREEP) for k in (0, -2))
    if wishes.from_speed_mps is None or wishes.to_speed_mps is None:
        notes.append("A speed at an end that was not given is the limit there.")
    return {
        "road": {name: list(road[name]) for name in ROAD},
        "from_speed_mps": _or(wishes.from_speed_mps, start),
        "to_speed_mps": _or(wishes.to_speed_mps, end),
        "min_speed_mps": min(slowest, _or(wishes.from_speed_mps, start), _or(wishes.to_speed_mps, end)),
        "max_time_s": wishes.max_time_s,
        "brake_max_n": BRAKING_MPS2 * mass_kg,
    }


def _or(value: float | None, ordinary: float) -> float:
    return ordinary if value is None else value
