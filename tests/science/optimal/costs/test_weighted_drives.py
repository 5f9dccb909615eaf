"""Drives for a weighted cost, where the truth is known another way."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.fields import ProblemError
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from tests.science.optimal.documents import TABLE_4_1, thesis

RPM = [1000.0, 2000.0, 4500.0, 6000.0]
NM = [0.0, 40.0, 100.0]
OMEGA = np.array(RPM) * np.pi / 30.0
WILLANS = {"willans": [3000.0, 2.4, 4e-6], "power_w": [0.0, 6e4], "force_n": [0.0, 5e3]}


def table(gps: Any) -> dict[str, Any]:
    """Return an emission map over the whole engine."""
    return {"rpm": RPM, "nm": NM, "gps": np.broadcast_to(gps, (len(RPM), len(NM))).tolist()}


def answered(problem: dict[str, Any]) -> dict[str, Any]:
    """Solve a document."""
    return solve(read_problem(problem)).document()


def test_a_constant_emission_is_a_price_of_time() -> None:
    """Grams g a second that weigh w cost w g for each second: the same as a second that is worth that."""
    timed = answered(thesis(time_s=8.4))
    rate = 0.02
    cost = {"weights": {"nox": timed["multiplier_w"] / rate}, "emissions": {"nox": table(rate)}}
    found = answered(thesis(cost=cost))
    assert found["time_s"] == pytest.approx(8.4, rel=1e-9)
    assert found["fuel_energy_j"] == pytest.approx(timed["fuel_energy_j"], rel=2e-6)
    assert found["switch_speeds_mps"] == pytest.approx(timed["switch_speeds_mps"], abs=1e-6)
    assert found["emissions_g"]["nox"] == pytest.approx(rate * 8.4, rel=1e-4)
    assert found["certificate"]["verdict"] == "optimal"
    assert "weighted cost" in found["certificate"]["notes"][-1]


def test_an_emission_that_follows_work_is_the_work_of_the_drive() -> None:
    per_joule = 1e-6
    cost = {"weights": {"fuel": 1.0, "hc": 2e5}, "emissions": {"hc": table(per_joule * np.outer(OMEGA, NM))}}
    found = answered(thesis(cost=cost))
    drive = {name: np.array(column, dtype=float) for name, column in found["trajectory"].items()}
    v, load = drive["speed_mps"], 0.5 * 1.2 * 0.39 * 1.93
    kinetic = 0.5 * 948.0 * (v[-1] ** 2 - v[0] ** 2)
    resisted = np.trapezoid(load * v**2 + 920.0 * 0.010 * 9.805, drive["distance_m"])
    assert found["emissions_g"]["hc"] == pytest.approx(per_joule * (kinetic + resisted), rel=2e-5)
    told = found["cost"]
    assert told["emissions"]["hc"]["largest_gps"] < 1e-9  # straight lines both ways: the formula is the table
    total = found["fuel_energy_j"] + 2e5 * told["emissions"]["hc"]["by_formula_g"]
    assert total == pytest.approx(told["weighted_energy_j"], rel=2e-6)
    assert told["emissions"]["hc"]["gps"] == pytest.approx(per_joule * drive["engine_speed_radps"] * drive["torque_nm"])


def test_an_emission_without_weight_is_counted_and_changes_nothing() -> None:
    plain, counted = answered(thesis()), answered(thesis(cost={"emissions": {"co": table(0.1)}}))
    assert counted["fuel_energy_j"] == pytest.approx(plain["fuel_energy_j"], rel=1e-12)
    assert counted["switch_speeds_mps"] == pytest.approx(plain["switch_speeds_mps"])
    assert counted["emissions_g"]["co"] == pytest.approx(0.1 * plain["time_s"], rel=1e-4)


def test_co2_follows_the_fuel() -> None:
    plain = answered(thesis())
    found = answered(thesis(cost={"weights": {"fuel": 0.0, "co2": 1e4}, "co2_g_per_mj": 70.0}))
    assert found["fuel_energy_j"] == pytest.approx(plain["fuel_energy_j"], rel=1e-9)
    assert found["emissions_g"] == {"co2": pytest.approx(plain["fuel_energy_j"] * 70e-6, rel=1e-9)}
    petrol = answered(thesis(cost={"weights": {"co2": 1.0}}))["emissions_g"]["co2"]
    litres = plain["fuel_energy_j"] / 32e6
    assert petrol / litres == pytest.approx(2360.0, rel=2e-3)  # 0.745 kg/l of which 86.4 % are carbon


@pytest.mark.parametrize("kind", ["accelerate", "distance"])
def test_a_willans_drive_weighs_fuel_and_co2(kind: str) -> None:
    ends = {"from_speed_mps": 10.0} | ({"to_speed_mps": 25.0} if kind == "accelerate" else {"distance_m": 300.0})
    problem = {"kind": kind, "vehicle": thesis()["vehicle"], "engine": WILLANS, **ends}
    plain, found = answered(problem), answered(problem | {"cost": {"weights": {"fuel": 1.0, "co2": 3e4}}})
    scale = 1.0 + 3e4 * found["cost"]["co2_g_per_mj"] * 1e-6
    assert found["fuel_energy_j"] == pytest.approx(plain["fuel_energy_j"], rel=1e-6)
    assert found["cost"]["weighted_energy_j"] == pytest.approx(scale * plain["fuel_energy_j"], rel=1e-6)
    assert found["trajectory"]["fuel_power_w"][0] == pytest.approx(plain["trajectory"]["fuel_power_w"][0], rel=1e-6)


def test_what_idles_emits_what_idling_emits() -> None:
    problem = {
        "kind": "distance",
        "vehicle": thesis()["vehicle"],
        "engine": TABLE_4_1 | {"idle_fuel_power_w": 4000.0},
        "transmission": {"type": "cvt", "neutral": True},
        "from_speed_mps": 20.0,
        "distance_m": 400.0,
    }
    idle = 0.003
    cost = {"weights": {"fuel": 1.0, "co": 10.0}, "emissions": {"co": table(idle) | {"idle_gps": idle}}}
    found = answered(problem | {"cost": cost})
    assert found["emissions_g"]["co"] == pytest.approx(idle * found["time_s"], rel=1e-9)
    assert "bound_j" in found["cost"]
    assert "bound_j" not in found


@pytest.mark.parametrize(
    ("cost", "words"),
    [
        ({"weights": {"soot": 1.0}}, "cost.weights.soot: there is no map of soot among cost.emissions"),
        ({"weights": {"fuel": -1.0}}, "cost.weights.fuel: -1 is out of range"),
        ({"weights": {"fuel": 0.0}}, "cost.weights: nothing has a weight above zero"),
        ({"weights": {"time": 5.0}}, "cost.weights.time: time is not weighed"),
        ({"weight": {}}, "cost.weight: is not a field of this problem; did you mean weights?"),
        ({"fuel": "coal"}, "cost.fuel: 'coal' is none of petrol, diesel"),
        ({"emissions": {f"e{k}": table(1.0) for k in range(13)}}, "cost.emissions: has 13 maps; 12 are allowed"),
        ({"emissions": {"fuel": table(1.0)}}, "cost.emissions.fuel: can't be the name of an emission"),
        ({"emissions": {"nox": table(1.0) | {"rpm": [1000, 1000, 2000, 6000]}}}, r"rpm\[1\]: 1000 is not above 1000"),
        ({"emissions": {"nox": table(1.0) | {"rpm": [1000, 2000, 6000]}}}, "nox.gps: has 4 rows; 3 are needed"),
        ({"emissions": {"nox": table(1.0) | {"rpm": [*NM[1:], 6000.0], "nm": RPM}}}, "each torque; turn it"),
        ({"emissions": {"nox": table(1.0) | {"nm": [0, 100]}}}, r"nox.gps\[0\]: has 3 values; 2 are needed"),
        ({"emissions": {"nox": table(-1.0)}}, r"nox.gps\[0\]\[0\]: -1 is out of range"),
        ({"emissions": {"nox": table(1.0) | {"nm": [20, 40, 100]}}}, "nm: begins at 20 Nm, the engine at 10: 10 to 20"),
        ({"emissions": {"nox": table(1.0) | {"rpm": [900, 1000, 2000, 5000]}}}, "ends at 5000 rpm, the engine at 6000"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_by_its_path(cost: dict[str, Any], words: str) -> None:
    with pytest.raises(ProblemError, match=words):
        read_problem(thesis(cost=cost))


def test_a_willans_drive_has_no_maps() -> None:
    problem = {"kind": "distance", "vehicle": thesis()["vehicle"], "engine": WILLANS, "from_speed_mps": 9.0}
    with pytest.raises(ProblemError, match="has no engine speed to look a map up with"):
        read_problem(problem | {"distance_m": 100.0, "cost": {"emissions": {"nox": table(1.0)}}})


def test_a_constant_emission_is_a_price_of_time_on_a_road_too() -> None:
    route = {
        "kind": "route",
        "vehicle": thesis()["vehicle"],
        "engine": {
            "p_in": [3500.0, 12.0, 2.35, 0.0025], "terms": ["1", "w", "wT", "wT2"], "speed_rpm": [1000, 6000],
            "torque_nm": [1, 100], "idle_fuel_power_w": 4500.0,
        },
        "transmission": {"type": "gears", "ratios": [7.37, 4.208], "neutral": True, "shift_cost_j": 2000.0},
        "road": {"distance_m": [0, 200, 400, 500], "elevation_m": [0, 4, 0, 0], "speed_limit_mps": [15, 20, 20, 20]},
        "from_speed_mps": 8.0, "to_speed_mps": 8.0, "min_speed_mps": 5.0, "brake_max_n": 4000.0,
    }  # fmt: skip
    timed = answered(route | {"max_time_s": 45.0})
    price, rate = timed["multiplier_w"], 0.02
    map_of_rate = table(rate) | {"nm": [0.0, 50.0, 100.0], "idle_gps": rate}
    found = answered(route | {"cost": {"weights": {"nox": price / rate}, "emissions": {"nox": map_of_rate}}})
    assert found["emissions_g"]["nox"] == pytest.approx(rate * found["time_s"], rel=1e-5)
    assert found["cost"]["weighted_energy_j"] == pytest.approx(timed["fuel_energy_j"] + price * 45.0, rel=2e-4)
    assert found["fuel_energy_j"] == pytest.approx(timed["fuel_energy_j"], rel=1e-2)
