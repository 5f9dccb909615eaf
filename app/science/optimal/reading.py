"""A JSON document as a problem; the names stand in docs/driving.md."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

from app.science.engine.fitting.terms import FitError, chosen_terms
from app.science.fields import Fields, ProblemError
from app.science.optimal.costs.reading import read_cost
from app.science.optimal.fuel_checks import check_fuel
from app.science.optimal.problem import (
    TABLE_4_1,
    Accelerate,
    BallAndWheel,
    Distance,
    Engine,
    PolynomialEngine,
    Problem,
    Road,
    RoadLoad,
    Route,
    Transmission,
    WillansDrive,
)

KINDS = ("accelerate", "distance", "route", "ball_and_wheel")
FASTEST_MPS = 150.0
HIGHEST_POWER = 5
"""Of engine speed or torque in the fuel power; the kernels keep that many coefficients."""

MapResolver = Callable[[Fields], Mapping[str, Any]]
"""Turns an engine object that names a map (``{"map": …}``) into one that says what the engine burns."""


def no_maps(engine: Fields) -> Mapping[str, Any]:
    """Refuse maps: there is nothing here to look them up in."""
    raise ProblemError(engine.path("map"), "maps can't be looked up here; give phi, p_in or willans.")


def read_problem(document: object, resolve_map: MapResolver = no_maps) -> Problem:
    """Read a problem document.

    Parameters
    ----------
    document : object
        As JSON gives it.
    resolve_map : callable
        Called with an engine that names a map.

    Raises
    ------
    ProblemError
        For a field that is missing, unknown, of the wrong kind, or out of range.
    """
    fields = Fields(document)
    kind = fields.word("kind", KINDS)
    if kind == "ball_and_wheel":
        return _ball_and_wheel(fields)
    load, engine = _load(fields.inner("vehicle")), read_engine(fields.inner("engine"), resolve_map)
    if fields.has("cost"):
        engine = read_cost(fields.inner("cost"), engine)
    willans = isinstance(engine, WillansDrive)
    gears = Transmission("cvt") if willans and not fields.has("transmission") else _gears(fields.inner("transmission"))
    brake_n = fields.number("brake_max_n", 0.0, 1e6, 0.0)
    start = fields.number("from_speed_mps", 0.0, FASTEST_MPS)
    if kind == "distance":
        if gears.kind != "cvt" and not willans:
            raise ProblemError("transmission.type", "a distance problem is for a CVT; for gears pose a route.")
        length = fields.number("distance_m", 0.0, 1e6, above=True)
        fields.close()
        return Distance(load, engine, gears, start, length, brake_n)
    end = fields.number("to_speed_mps", 0.0, FASTEST_MPS)
    if kind == "accelerate":
        time_s = fields.number("time_s", 0.0, 1e5, above=True) if fields.has("time_s") else None
        fields.close()
        if end <= start:
            raise ProblemError("to_speed_mps", f"{end:g} is not above from_speed_mps, {start:g}.")
        return Accelerate(load, engine, gears, start, end, time_s, brake_n)
    lowest = fields.number("min_speed_mps", 0.0, FASTEST_MPS)
    longest = fields.number("max_time_s", 0.0, 1e6, above=True) if fields.has("max_time_s") else None
    road = _road(fields.inner("road"))
    fields.close()
    return Route(load, engine, gears, road, start, end, lowest, longest, brake_n)


def _load(fields: Fields) -> RoadLoad:
    mass = fields.number("mass_kg", 10.0, 2e5)
    load = RoadLoad(
        mass_kg=mass,
        accelerated_mass_kg=fields.number("accelerated_mass_kg", mass, 3.0 * mass),
        cd=fields.number("cd", 0.0, 3.0),
        frontal_area_m2=fields.number("frontal_area_m2", 0.0, 30.0),
        crr=fields.number("crr", 0.0, 0.3),
        air_density_kgpm3=fields.number("air_density_kgpm3", 0.0, 3.0),
        gravity_mps2=fields.number("gravity_mps2", 0.0, 30.0, above=True),
        wheel_radius_m=fields.number("wheel_radius_m", 0.05, 2.0),
    )
    fields.close()
    return load


def read_engine(fields: Fields, resolve_map: MapResolver = no_maps) -> Engine:
    """Read the ``engine`` of a problem; raises `ProblemError`."""
    if fields.has("map"):
        fields = Fields(resolve_map(fields), "engine")
    if fields.has("willans"):
        return _willans(fields)
    of_phi = fields.has("phi")
    name = "phi" if of_phi or not fields.has("p_in") else "p_in"
    terms = _terms(fields) if fields.has("terms") or name == "p_in" else TABLE_4_1
    numbers = fields.numbers(name, -1e12, 1e12, len(terms))
    if of_phi and fields.has("p_in"):
        raise ProblemError(fields.path("p_in"), "give phi or p_in, not both.")
    engine = PolynomialEngine(
        terms=tuple((i + 1, j + 1) for i, j in terms) if of_phi else terms,
        coefficients=numbers,
        speed_rpm=fields.pair("speed_rpm", 0.0, 50_000.0),
        torque_nm=fields.pair("torque_nm", -5_000.0, 50_000.0),
        full_load=_full_load(fields) if fields.has("full_load") else (),
        idle_fuel_power_w=fields.number("idle_fuel_power_w", 0.0, 1e6, 0.0),
    )
    fields.close()
    if max(max(term) for term in engine.terms) > HIGHEST_POWER:
        raise ProblemError(fields.path("terms"), f"the fuel power has powers above {HIGHEST_POWER}; take fewer.")
    check_fuel(engine, fields.path(name))
    return engine


def _terms(fields: Fields) -> tuple[tuple[int, int], ...]:
    words = fields.get("terms")
    if not isinstance(words, list | tuple) or not all(isinstance(word, str) for word in words):
        raise ProblemError(fields.path("terms"), 'is not a list of terms such as ["1", "w", "T", "wT"].')
    try:
        return chosen_terms(words).terms
    except FitError as error:
        raise ProblemError(fields.path("terms"), str(error)) from error


def _full_load(fields: Fields) -> tuple[tuple[float, float], ...]:
    path, points = fields.path("full_load"), fields.get("full_load")
    if not isinstance(points, list | tuple) or not points:
        raise ProblemError(path, "is not a list of [rpm, Nm] points; null stands for none.")
    line: list[tuple[float, float]] = []
    for k, point in enumerate(points):
        rpm, nm = Fields({"point": point}, f"{path}[{k}]").numbers("point", 0.0, 50_000.0, 2)
        if line and rpm <= line[-1][0]:
            raise ProblemError(f"{path}[{k}]", f"{rpm:g} rpm is not above {line[-1][0]:g} rpm of the point before.")
        line.append((rpm, nm))
    return tuple(line)


def _willans(fields: Fields) -> WillansDrive:
    c0, c1, c2 = fields.numbers("willans", -1e9, 1e9, 3)
    drive = WillansDrive((c0, c1, c2), fields.pair("power_w", -1e7, 1e7), fields.pair("force_n", -1e6, 1e6))
    fields.close()
    if c0 < 0.0:
        raise ProblemError(fields.path("willans[0]"), f"{c0:g} W burned without load is below zero.")
    for power in drive.power_w:
        if c1 + 2.0 * c2 * power < 0.0:
            raise ProblemError(fields.path("willans"), f"fuel falls with power at {power:g} W; no drive does that.")
    return drive


def _gears(fields: Fields) -> Transmission:
    kind: Literal["gears", "cvt"] = "gears" if fields.word("type", ("gears", "cvt")) == "gears" else "cvt"
    ratios: tuple[float, ...] = ()
    if kind == "gears":
        ratios = fields.numbers("ratios", 0.01, 1000.0)
        if not 1 <= len(ratios) <= 32:
            raise ProblemError(fields.path("ratios"), f"has {len(ratios)} gears; allowed are 1 to 32.")
        for k in range(1, len(ratios)):
            if not ratios[k] < ratios[k - 1]:
                raise ProblemError(
                    fields.path(f"ratios[{k}]"), f"{ratios[k]:g} is not below {ratios[k - 1]:g} of the gear before."
                )
    elif fields.has("ratios") and fields.get("ratios"):
        raise ProblemError(fields.path("ratios"), "a CVT has none; leave them out or say gears.")
    found = Transmission(kind, ratios, fields.flag("neutral", False), fields.number("shift_cost_j", 0.0, 1e9, 0.0))
    fields.close()
    return found


def _road(fields: Fields) -> Road:
    distance = fields.numbers("distance_m", -1e7, 1e7)
    if len(distance) < 2:
        raise ProblemError(fields.path("distance_m"), "a road needs two points at least.")
    for k in range(1, len(distance)):
        if distance[k] <= distance[k - 1]:
            raise ProblemError(
                fields.path(f"distance_m[{k}]"), f"{distance[k]:g} m is not beyond {distance[k - 1]:g} m before it."
            )
    elevation = fields.numbers("elevation_m", -1e4, 1e4, len(distance))
    for k in range(1, len(distance)):
        grade = (elevation[k] - elevation[k - 1]) / (distance[k] - distance[k - 1])
        if abs(grade) > 0.5:
            raise ProblemError(
                fields.path(f"elevation_m[{k}]"),
                f"the road would rise by {100.0 * grade:.0f} m per 100 m; allowed is 50.",
            )
    limits = fields.numbers("speed_limit_mps", 0.0, FASTEST_MPS, len(distance))
    fields.close()
    return Road(distance, elevation, limits)


def _ball_and_wheel(fields: Fields) -> BallAndWheel:
    problem = BallAndWheel(
        x1=fields.number("x1", -1e6, 1e6),
        x2=fields.number("x2", -1e6, 1e6),
        u_min=fields.number("u_min", -1e6, 1e6),
        u_max=fields.number("u_max", -1e6, 1e6),
        gamma=fields.number("gamma", 0.0, 1e6, above=True),
    )
    fields.close()
    return problem
