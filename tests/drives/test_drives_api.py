"""Drives over REST: posed, solved by a job, answered, saved, removed; and what is told when there is no answer."""

from __future__ import annotations

import csv
import io
import threading
import time
from typing import Any

import pyarrow.parquet as pq
import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.drives import service
from app.drives.keys import drives_root
from app.drives.schemas import ACCELERATE
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from tests.drives.conftest import Desk

CASE = solve(read_problem(ACCELERATE)).document()
"""The thesis' acceleration, solved without the service."""


def test_a_drive_is_solved_by_a_job_and_its_answer_is_that_of_the_command(desk: Desk) -> None:
    posed = desk.pose()
    assert (posed["state"], posed["kind"], posed["name"]) == ("waiting", "accelerate", "36 to 100 km/h")
    assert posed["problem"] == ACCELERATE
    assert desk.work(posed["job_id"]) == "succeeded"
    drive = desk.ask("GET", f"/{posed['id']}")
    assert (drive["state"], drive["failure"], drive["verdict"]) == ("solved", None, "optimal")
    assert drive["fuel_energy_j"] == pytest.approx(CASE["fuel_energy_j"], rel=1e-12)
    answer = desk.ask("GET", f"/{posed['id']}/answer")
    provenance = answer.pop("provenance")
    assert provenance["problem_sha256"] == posed["problem_sha256"]
    assert provenance["code_version"] == desk.resources.settings.code_version
    assert answer.keys() == CASE.keys()
    assert answer["gears"] == CASE["gears"]
    assert answer["trajectory"]["speed_mps"] == pytest.approx(CASE["trajectory"]["speed_mps"], rel=1e-12)
    assert desk.client.get("/api/v1/jobs", params={"drive_id": posed["id"]}).json()["items"][0]["kind"] == "drive"


def test_a_bare_problem_is_taken_and_waited_for(desk: Desk) -> None:
    def worker() -> None:
        end = time.monotonic() + 20.0
        while time.monotonic() < end:
            waiting = desk.client.get("/api/v1/jobs", params={"state": "queued"}).json()["items"]
            if waiting:
                desk.work(waiting[0]["id"])
                return

    playing = threading.Thread(target=worker)
    playing.start()
    drive = desk.ask("POST", "", 201, params={"wait": 20}, json=ACCELERATE)
    playing.join()
    assert drive["state"] == "solved"
    assert drive["answer"]["time_s"] == pytest.approx(CASE["time_s"], rel=1e-12)


def test_waiting_ends_when_nobody_works(desk: Desk) -> None:
    drive = desk.ask("POST", "", 202, params={"wait": 0.2}, json=ACCELERATE)
    assert (drive["state"], drive["answer"]) == ("waiting", None)


WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({"vehicle": ACCELERATE["vehicle"] | {"mass_kg": -1}}, "vehicle.mass_kg", "/vehicle/mass_kg"),
    ({"engine": ACCELERATE["engine"] | {"phi": [1, "a", 0, 0, 0, 0]}}, "engine.phi[1]", "/engine/phi/1"),
    ({"engine": {"map": "f" * 32}}, "engine.map", "/engine/map"),
    ({"engine": {"map": "somewhere"}}, "engine.map", "/engine/map"),
    ({"to_speed": 3.0}, "to_speed", "/to_speed"),
    ({"kind": "fly"}, "kind", "/kind"),
    ({"kind": "route", "road": {"distance_m": [0.0] * 20_001}}, "road.distance_m", "/road/distance_m"),
]


def test_what_is_wrong_in_a_problem_is_told_at_once_by_its_field(desk: Desk) -> None:
    for changed, path, pointer in WRONG:
        refused = desk.ask("POST", "", 422, json={"problem": ACCELERATE | changed})
        assert (refused["code"], refused["path"], refused["pointer"]) == ("problem-document", path, pointer)
        assert refused["detail"].startswith(path)
    assert desk.ask("GET", "")["items"] == []


def test_other_bodies_are_refused(desk: Desk) -> None:
    assert desk.ask("POST", "", 422, json={"problem": 3})["field"] == "body.problem"
    assert desk.ask("POST", "", 422, json={"problem": ACCELERATE, "nmae": "x"})["field"] == "body.nmae"
    assert desk.ask("POST", "", 422, json={"problem": ACCELERATE, "car_id": "f" * 32})["field"] == "body.car_id"
    assert "2000000" in desk.ask("POST", "", 413, content=b" " * 2_000_001)["detail"].replace(" ", "")


def test_a_drive_that_cannot_be_is_told_by_the_limit_that_binds(desk: Desk) -> None:
    posed = desk.pose(to_speed_mps=120.0)
    assert desk.work(posed["job_id"]) == "failed"
    drive = desk.ask("GET", f"/{posed['id']}")
    assert (drive["state"], drive["fuel_energy_j"]) == ("infeasible", None)
    refused = desk.ask("GET", f"/{posed['id']}/answer", 422)
    assert (refused["code"], refused["limit"], refused["drive_id"]) == (
        "infeasible",
        "transmission.ratios",
        posed["id"],
    )
    assert refused["pointer"] == "/transmission/ratios"
    assert "57.46 m/s" in refused["detail"]
    assert drive["failure"]["detail"] == refused["detail"]
    assert desk.ask("POST", f"/{posed['id']}/compare", 409, json={})["code"] == "drive-not-solved"


def test_of_two_limits_that_clash_both_are_named(desk: Desk) -> None:
    car = {name: ACCELERATE[name] for name in ("vehicle", "engine", "transmission")}
    road = {"distance_m": [0.0, 500.0], "elevation_m": [0.0, 0.0], "speed_limit_mps": [15.0, 15.0]}
    ends = {"from_speed_mps": 40.0, "to_speed_mps": 12.0, "min_speed_mps": 5.0}
    posed = desk.ask("POST", "", 202, json={"kind": "route", **car, "road": road, **ends})
    assert desk.work(posed["job_id"]) == "failed"
    refused = desk.ask("GET", f"/{posed['id']}/answer", 422)
    assert refused["limits"] == ["from_speed_mps", "road.speed_limit_mps"]
    assert refused["pointer"] == "/from_speed_mps"


def test_until_it_is_solved_the_reason_is_told_and_a_cancelled_one_can_be_retried(desk: Desk) -> None:
    posed = desk.pose()
    at = f"/{posed['id']}"
    early = desk.client.get(f"/api/v1/drives{at}/answer")
    assert (early.status_code, early.json()["code"]) == (409, "answer-not-ready")
    assert early.headers["retry-after"] == "1"
    desk.client.post(f"/api/v1/jobs/{posed['job_id']}/cancel")
    assert desk.ask("GET", at)["state"] == "cancelled"
    assert desk.ask("GET", f"{at}/answer", 409)["code"] == "cancelled"
    assert desk.ask("GET", f"{at}/comparison", 409)["code"] == "no-comparison"
    desk.client.post(f"/api/v1/jobs/{posed['job_id']}/retry")
    assert desk.work(posed["job_id"]) == "succeeded"
    assert desk.ask("GET", f"{at}/answer")["gears"] == CASE["gears"]


def test_methods_are_compared_by_a_job_of_their_own(desk: Desk) -> None:
    posed = desk.pose()
    desk.work(posed["job_id"])
    wish = {"methods": ["pontryagin", "dp_speed"]}
    refused = desk.ask("POST", f"/{posed['id']}/compare", 422, json={"methods": ["guessing"]})
    assert refused["field"] == "body.methods"
    job = desk.ask("POST", f"/{posed['id']}/compare", 202, json=wish)
    assert desk.ask("POST", f"/{posed['id']}/compare", 202, json=wish)["id"] == job["id"]
    assert desk.work(job["id"]) == "succeeded"
    rows = {row["name"]: row for row in desk.ask("GET", f"/{posed['id']}/comparison")["rows"]}
    assert rows["pontryagin"]["fuel_energy_j"] == pytest.approx(CASE["fuel_energy_j"], rel=1e-9)
    assert abs(rows["dp_speed"]["relative_error"]) < 1e-3
    assert desk.ask("GET", f"/{posed['id']}")["jobs"]["compare"] == job["id"]
    assert desk.ask("GET", f"/{posed['id']}/figures/methods")["data"]


def test_a_front_is_drawn_by_a_job_of_its_own(desk: Desk) -> None:
    posed = desk.pose()
    desk.work(posed["job_id"])
    job = desk.ask("POST", f"/{posed['id']}/front", 202, json={"emission": "time", "points": 3})
    assert desk.work(job["id"]) == "succeeded"
    points = desk.ask("GET", f"/{posed['id']}/front")["points"]
    assert points[0]["fuel_energy_j"] == pytest.approx(CASE["fuel_energy_j"], rel=1e-9)
    assert [p["time_s"] for p in points] == sorted((p["time_s"] for p in points), reverse=True)
    job = desk.ask("POST", f"/{posed['id']}/front", 202, json={"emission": "nox"})
    assert desk.work(job["id"]) == "failed"
    assert "nox" in desk.client.get(f"/api/v1/jobs/{job['id']}").json()["problem"]["detail"]
    assert len(desk.ask("GET", f"/{posed['id']}/front")["points"]) == 3


def test_figures_are_drawn_alone_and_over_each_other(desk: Desk) -> None:
    one, other = desk.pose(), desk.pose(time_s=8.0)
    assert desk.ask("GET", f"/{one['id']}/figures/speed", 409)["code"] == "answer-not-ready"
    for drive in (one, other):
        desk.work(drive["job_id"])
    for theme in ("light", "dark"):
        alone = desk.ask("GET", f"/{one['id']}/figures/speed", params={"theme": theme})
        both = {"theme": theme, "over": "distance", "other": other["id"]}
        together = desk.ask("GET", f"/{one['id']}/figures/speed", params=both)
        assert len(together["data"]) > len(alone["data"])
    assert desk.ask("GET", f"/{one['id']}/figures/speed", 404, params={"other": "0" * 32})["code"] == "not-found"


def test_files_hold_the_trajectory_and_the_problem(desk: Desk) -> None:
    posed = desk.pose()
    problem = desk.client.get(f"/api/v1/drives/{posed['id']}/export", params={"format": "problem"})
    assert problem.json() == ACCELERATE
    desk.work(posed["job_id"])
    at = f"/api/v1/drives/{posed['id']}/export"
    rows = list(csv.DictReader(io.StringIO(desk.client.get(at, params={"format": "csv"}).text)))
    assert [float(row["speed_mps"]) for row in rows] == pytest.approx(CASE["trajectory"]["speed_mps"], rel=1e-12)
    assert [int(row["gear"]) for row in rows] == CASE["trajectory"]["gear"]
    table = pq.read_table(io.BytesIO(desk.client.get(at, params={"format": "parquet"}).content))
    assert table["costate_speed"].to_pylist() == pytest.approx(CASE["costates"]["speed"], rel=1e-12)
    whole = desk.client.get(at)
    assert whole.json()["fuel_energy_j"] == pytest.approx(CASE["fuel_energy_j"], rel=1e-12)
    assert whole.json()["problem"] == ACCELERATE
    assert "36 to 100 km-h.answer.json" in whole.headers["content-disposition"]


def test_a_ball_on_a_wheel_has_its_synthesis_and_no_table_of_a_car(desk: Desk) -> None:
    ball = {"kind": "ball_and_wheel", "x1": 1.0, "x2": 0.0, "u_min": -1.0, "u_max": 1.0, "gamma": 1.0}
    drive = desk.ask("POST", "", 202, json={"name": "Ball", "problem": ball})
    desk.work(drive["job_id"])
    assert desk.ask("GET", f"/{drive['id']}")["time_s"] == pytest.approx(2.0, rel=1e-9)
    assert desk.ask("GET", f"/{drive['id']}/answer")["first"] == "u_min"
    assert desk.ask("GET", f"/{drive['id']}/figures/synthesis")["data"]
    assert desk.ask("GET", "", params={"kind": "accelerate"})["items"] == []
    assert len(desk.ask("GET", "", params={"kind": "ball_and_wheel"})["items"]) == 1


def test_a_drive_is_renamed_solved_again_and_removed_with_its_files(desk: Desk) -> None:
    posed = desk.pose()
    at = f"/{posed['id']}"
    desk.work(posed["job_id"])
    assert desk.ask("PATCH", at, json={"name": " Up the ramp "})["name"] == "Up the ramp"
    again = desk.ask("POST", f"{at}/solve", 202)
    assert again["id"] != posed["job_id"]
    assert desk.ask("GET", at)["state"] == "waiting"
    assert desk.ask("GET", f"{at}/answer")["gears"] == CASE["gears"]
    blobs = desk.resources.blobs
    assert len(blobs.keys(drives_root(FLEET))) == 1
    desk.ask("DELETE", at, 204)
    desk.ask("GET", at, 404)
    assert desk.client.get(f"/api/v1/jobs/{again['id']}").status_code == 404
    assert desk.work(again["id"]) == "refused"
    assert service.sweep(desk.resources, FLEET) == 1
    assert blobs.keys(drives_root(FLEET)) == []
