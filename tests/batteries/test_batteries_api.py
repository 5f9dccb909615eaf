"""Batteries over REST: given to cars, configured through the car's XML, renamed, removed; what is refused and where."""

from __future__ import annotations

from typing import Any

from app.figures.battery import NAMES
from tests.batteries.conftest import CONFIG, Bench


def test_a_battery_is_written_into_the_cars_file_and_read_back(bench: Bench) -> None:
    path = bench.make()
    battery = bench.ask("GET", path)
    assert (battery["car_id"], battery["name"], battery["missing"]) == (bench.car_id, "Battery of hybrid", [])
    assert (battery["rated_capacity_ah"], battery["end_of_life"], battery["newest"]) == (2.2, 0.8, None)
    xml = bench.client.get(f"/api/v1/cars/{bench.car_id}/config").text
    assert '<capacity rated="2.2" initial="2.2"/>' in xml
    config = bench.ask("GET", f"{path}/config")
    assert config == CONFIG | {"series": 1, "parallel": 1}
    assert bench.ask("PUT", f"{path}/config", json=config) == config
    car = bench.client.get(f"/api/v1/cars/{bench.car_id}").json()
    assert (car["battery_ids"], car["config_revision"]) == ([path[1:]], 2)
    assert bench.ask("GET", "", params={"car_id": bench.car_id})["items"] == [battery]


def test_a_configuration_that_is_put_is_a_new_revision_of_the_cars_file(bench: Bench) -> None:
    path = bench.make()
    changed = CONFIG | {"series": 96, "parallel": 2, "estimator": "ukf"}
    assert bench.ask("PUT", f"{path}/config", json=changed) == changed
    battery = bench.ask("GET", path)
    assert (battery["series"], battery["parallel"], battery["estimator"]) == (96, 2, "ukf")
    assert battery["config_revision"] == 3
    renamed = bench.ask("PATCH", path, json={"name": "Main pack", "end_of_life": 0.7})
    assert (renamed["name"], renamed["end_of_life"], renamed["config_revision"]) == ("Main pack", 0.7, 4)
    assert bench.ask("GET", f"{path}/config") == changed


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"initial": CONFIG["initial"] | {"capacity_ah": -1.0}}, "/initial/capacity_ah"),
    ({"initial": CONFIG["initial"] | {"soc": 60.0}}, "/initial/soc"),
    ({"estimator": "guess"}, "/estimator"),
    ({"ocv": [[0.0, 3.0], [0.5, 2.9], [1.0, 4.0]]}, "/ocv/1"),
    ({"capacity": 3.0}, "/capacity"),
    ({"gains": {"alpha": "much"}}, "/gains/alpha"),
]


def test_what_is_wrong_in_a_configuration_is_told_by_its_field(bench: Bench) -> None:
    for changed, pointer in WRONG:
        body = {"car_id": bench.car_id, "config": CONFIG | changed}
        refused = bench.ask("POST", "", 422, json=body)
        assert refused["pointer"].startswith(pointer), refused
    assert bench.ask("GET", "")["items"] == []
    path = bench.make()
    for changed, pointer in WRONG:
        assert bench.ask("PUT", f"{path}/config", 422, json=CONFIG | changed)["pointer"].startswith(pointer)
    assert bench.ask("GET", path)["config_revision"] == 2


def test_other_bodies_are_refused(bench: Bench) -> None:
    nobodys = {"car_id": "f" * 32, "config": CONFIG}
    assert bench.ask("POST", "", 422, json=nobodys)["field"] == "body.car_id"
    assert bench.ask("POST", "", 422, json=nobodys | {"colour": "red"})["field"] == "body.colour"
    path = bench.make()
    assert bench.ask("POST", "", 409, json={"car_id": bench.car_id, "config": CONFIG})["code"] == "car-has-battery"
    assert bench.ask("PATCH", path, 422, json={"end_of_life": 80})["field"] == "body.end_of_life"
    assert bench.ask("GET", f"/{'0' * 32}", 404)["code"] == "not-found"


def test_a_car_whose_file_gains_a_battery_has_one(bench: Bench) -> None:
    bench.make(series=4)
    xml = bench.client.get(f"/api/v1/cars/{bench.car_id}/config").content
    other = bench.client.post("/api/v1/cars", content=xml, headers={"Content-Type": "application/xml"}).json()
    (battery_id,) = other["battery_ids"]
    assert bench.ask("GET", f"/{battery_id}")["series"] == 4
    third = bench.client.post("/api/v1/cars", json={}).json()["id"]
    partly = b'<ponthy_config><battery name="Sealed"><cells series="96"/></battery></ponthy_config>'
    assert bench.client.put(f"/api/v1/cars/{third}/config", content=partly).status_code == 200
    battery = bench.ask("GET", "", params={"car_id": third})["items"][0]
    assert (battery["name"], battery["series"]) == ("Sealed", 96)
    assert "open-circuit curve" in battery["missing"]
    refused = bench.send(f"/{battery['id']}", b"t_s,current_a,voltage_v\n0,1,3\n1,1,3\n", 422)
    assert refused["pointer"] == "/ocv"


def test_a_battery_that_is_taken_out_of_the_file_keeps_its_history_until_it_is_removed(bench: Bench) -> None:
    path = bench.make()
    bench.client.put(f"/api/v1/cars/{bench.car_id}/config", content=b"<ponthy_config/>")
    assert bench.ask("GET", path)["missing"] == ["battery in the car's file"]
    assert bench.ask("GET", f"{path}/config", 409)["code"] == "no-battery-in-file"
    assert bench.ask("PUT", f"{path}/config", json=CONFIG)["rated_capacity_ah"] == 2.2
    bench.ask("DELETE", path, 204)
    assert bench.ask("GET", path, 404)["code"] == "not-found"
    assert b"<battery" not in bench.client.get(f"/api/v1/cars/{bench.car_id}/config").content
    assert bench.make() != path


def test_a_car_goes_with_its_battery(bench: Bench) -> None:
    path = bench.make()
    job = bench.send(path, b"t_s,current_a,voltage_v\n0,1,3.3\n1,2,3.4\n")["job"]
    assert bench.client.delete(f"/api/v1/cars/{bench.car_id}").status_code == 204
    assert bench.client.get(f"/api/v1/jobs/{job['id']}").status_code == 404
    assert bench.ask("GET", path, 404)["code"] == "not-found"


def test_laboratory_tests_are_kept(bench: Bench) -> None:
    path = bench.make()
    late = {"at": "2026-03-01T12:00:00+01:00", "capacity_ah": 1.95, "capacity_ah_sd": 0.02, "note": "1C"}
    kept = bench.ask("POST", f"{path}/tests", 201, json=late)
    assert (kept["at"], kept["capacity_ah"]) == ("2026-03-01T11:00:00Z", 1.95)
    bench.ask("POST", f"{path}/tests", 201, json={"at": "2025-03-01", "capacity_ah": 2.1})
    listed = bench.ask("GET", f"{path}/tests")["items"]
    assert [test["capacity_ah"] for test in listed] == [1.95, 2.1]
    compared = bench.ask("GET", f"{path}/ageing")["tests"]
    assert [test["capacity_ah"] for test in compared] == [2.1, 1.95]
    for wrong in ({"capacity_ah": 0.0}, {"at": "yesterday"}, {"capacity_ah_sd": -1.0}):
        bench.ask("POST", f"{path}/tests", 422, json=late | wrong)
    bench.ask("DELETE", f"{path}/tests/{kept['id']}", 204)
    assert len(bench.ask("GET", f"{path}/tests")["items"]) == 1


def test_without_an_estimate_figures_say_so(bench: Bench) -> None:
    path = bench.make()
    for name in NAMES:
        assert "layout" in bench.ask("GET", f"{path}/figures/{name}", params={"theme": "dark"})
    assert bench.ask("GET", f"{path}/export", 409)["code"] == "no-history"
