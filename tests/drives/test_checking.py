"""A problem can be checked without being kept."""

from __future__ import annotations

from app.drives.schemas import ACCELERATE
from tests.drives.conftest import Desk


def test_a_problem_is_checked_and_not_kept(desk: Desk) -> None:
    found = desk.ask("POST", "/check", 200, json={"problem": ACCELERATE})
    assert (found["kind"], found["name"]) == ("accelerate", "36 to 100 km/h")
    assert "concave" in found["warnings"][0]
    assert desk.ask("GET", "")["items"] == []


def test_what_is_wrong_is_told_by_its_field(desk: Desk) -> None:
    wrong = ACCELERATE | {"to_speed_mps": 5.0}
    problem = desk.ask("POST", "/check", 422, json={"problem": wrong})
    assert problem["path"] == "to_speed_mps"
    assert "is not above from_speed_mps, 10" in problem["detail"]
    assert desk.ask("POST", "/check", 422, json={"problem": ACCELERATE, "car_id": "f" * 32})["field"] == "body.car_id"
