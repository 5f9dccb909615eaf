"""Problem documents are read, and what is wrong with one is named by its path."""

from __future__ import annotations

from typing import Any

import pytest

from app.science.fields import ProblemError
from app.science.optimal.fuel_checks import concavity
from app.science.optimal.problem import Accelerate, BallAndWheel, Distance, PolynomialEngine, Route, WillansDrive
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SMART, TABLE_4_1, thesis

WILLANS = {"willans": [8000.0, 2.6, 0.0], "power_w": [0.0, 60_000.0], "force_n": [0.0, 4000.0]}
ROAD = {"distance_m": [0, 500, 1200], "elevation_m": [10, 30, 5], "speed_limit_mps": [20, 25, 25]}


def changed(path: str, value: Any) -> dict[str, Any]:
    """Return the thesis' problem with one field set, or taken out with ``...``."""
    document = thesis()
    *parents, name = path.split(".")
    inner = document
    for parent in parents:
        inner[parent] = dict(inner[parent])
        inner = inner[parent]
    if value is ...:
        del inner[name]
    else:
        inner[name] = value
    return document


def test_every_kind_is_read() -> None:
    accelerate = read_problem(thesis(time_s=12.0))
    assert isinstance(accelerate, Accelerate)
    assert (accelerate.time_s, accelerate.transmission.ratios[5]) == (12.0, 3.23)
    assert isinstance(accelerate.engine, PolynomialEngine)
    cvt = {"transmission": {"type": "cvt"}, "vehicle": SMART, "engine": TABLE_4_1, "from_speed_mps": 20}
    assert isinstance(read_problem({"kind": "distance", "distance_m": 3000, **cvt}), Distance)
    ends = {"to_speed_mps": 15, "min_speed_mps": 5, "max_time_s": None, "brake_max_n": 5000}
    route = read_problem({"kind": "route", "road": ROAD, **cvt, **ends})
    assert isinstance(route, Route)
    assert route.road.elevation_m == (10.0, 30.0, 5.0)
    ball = read_problem({"kind": "ball_and_wheel", "x1": 1, "x2": 0, "u_min": -1, "u_max": 1, "gamma": 2})
    assert ball == BallAndWheel(1.0, 0.0, -1.0, 1.0, 2.0)


def test_a_willans_drive_needs_no_transmission() -> None:
    document = thesis(engine=WILLANS)
    del document["transmission"]
    problem = read_problem(document)
    assert isinstance(problem, Accelerate)
    assert problem.engine == WillansDrive((8000.0, 2.6, 0.0), (0.0, 60_000.0), (0.0, 4000.0))


def test_fuel_power_with_other_terms_is_read() -> None:
    engine = {"p_in": [900.0, 20.0, 2.5], "terms": ["1", "w", "wT"], "speed_rpm": [900, 5000], "torque_nm": [0, 150]}
    problem = read_problem(thesis(engine=engine))
    assert isinstance(problem, Accelerate)
    assert isinstance(problem.engine, PolynomialEngine)
    assert problem.engine.terms == ((0, 0), (1, 0), (1, 1))


def test_a_map_is_looked_up_by_whoever_reads() -> None:
    document = thesis(engine={"map": "a"})
    assert read_problem(document, lambda fields: {**TABLE_4_1, "phi": list(TABLE_4_1["phi"])}) == read_problem(thesis())
    with pytest.raises(ProblemError, match=r"engine\.map"):
        read_problem(document)


def test_table_4_1_is_concave_below_63_nm() -> None:
    problem = read_problem(thesis())
    assert isinstance(problem, Accelerate)
    found = concavity(problem.engine)
    assert found is not None
    # where the second derivative of T φ in T is zero: T = −(α₂ + α₃ω) / (3 α₅), at the lowest engine speed
    assert found.below_nm == pytest.approx((0.068797 - 3.7201e-06 * 104.72) / (3 * 3.6204e-04), abs=0.4)
    assert found.from_bottom


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("kind", "acelerate", "did you mean accelerate"),
        ("vehicle.mass_kg", -920, "vehicle.mass_kg: -920 is out of range; allowed is from 10"),
        ("vehicle.mass_kg", "920", "vehicle.mass_kg: '920' is not a number"),
        ("vehicle.mass_kg", float("nan"), "vehicle.mass_kg: nan is not a finite number"),
        ("vehicle.mass_kg", True, "vehicle.mass_kg: True is not a number"),
        ("vehicle.mass_kg", ..., "vehicle.mass_kg: is missing"),
        ("vehicle.accelerated_mass_kg", 900, "vehicle.accelerated_mass_kg: 900 is out of range; allowed is from 920"),
        ("vehicle.mass", 920, "vehicle.mass: is not a field of this problem; did you mean mass_kg"),
        ("vehicle", [1], "vehicle: [1] is not an object"),
        ("engine.phi", [1, 2], "engine.phi: has 2 numbers; 6 are needed"),
        ("engine.phi", [-9, 0, 0, 0, 0, 0], "engine.phi: fuel power is"),
        ("engine.speed_rpm", [6000, 1000], "engine.speed_rpm: the lowest, 6000, is not below"),
        ("engine.full_load", [[2000, 80], [1000, 90]], "engine.full_load[1]: 1000 rpm is not above 2000"),
        ("engine.full_load", [[1000, 5]], "engine.full_load: the engine never gives more than"),
        ("transmission.ratios", [3, 5], "transmission.ratios[1]: 5 is not below 3"),
        ("transmission.ratios", [], "transmission.ratios: has 0 gears"),
        ("transmission.neutral", "yes", "transmission.neutral: 'yes' is neither true nor false"),
        ("transmission.shift_cost_j", -1, "transmission.shift_cost_j: -1 is out of range"),
        ("to_speed_mps", 9.0, "to_speed_mps: 9 is not above from_speed_mps, 10"),
        ("time_s", 0, "time_s: 0 is out of range; allowed is above 0"),
        ("times_s", 3, "times_s: is not a field of this problem; did you mean time_s"),
    ],
)
def test_what_is_wrong_is_named_by_its_path(path: str, value: Any, words: str) -> None:
    with pytest.raises(ProblemError) as refused:
        read_problem(changed(path, value))
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("road", "words"),
    [
        ({**ROAD, "distance_m": [0, 500, 400]}, "road.distance_m[2]: 400 m is not beyond 500 m"),
        ({**ROAD, "elevation_m": [10, None, 5]}, "road.elevation_m[1]: null is not a number"),
        ({**ROAD, "speed_limit_mps": [20, 25]}, "road.speed_limit_mps: has 2 numbers; 3 are needed"),
        ({**ROAD, "elevation_m": [10, 400, 5]}, "road.elevation_m[1]: the road would rise by 78 m per 100 m"),
    ],
)
def test_gaps_in_a_road_are_named(road: dict[str, Any], words: str) -> None:
    document = thesis(kind="route", road=road, min_speed_mps=5.0, max_time_s=300.0, brake_max_n=4000.0)
    del document["time_s"]
    with pytest.raises(ProblemError) as refused:
        read_problem(document)
    assert words in str(refused.value)
