"""Files of current and voltage: kept, estimated by jobs in the order of time, answered, drawn, saved."""

from __future__ import annotations

import csv
import gzip
import io
import threading
import time
from datetime import timedelta
from typing import Any

import pyarrow.parquet as pq
import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.batteries import receiving, service, working
from app.batteries.estimating import Question
from app.batteries.keys import battery_folder
from app.imports.battery import read_battery
from app.science.battery.config_reading import read_config
from app.science.battery.estimate import estimate
from app.science.progress import Progress
from tests.batteries.conftest import BEGAN, CONFIG, TRUTH, Bench, table
from workers.holding import PROGRESS_EVERY_S

FIRST, SECOND = table(1, 0.5), table(2, 0.5)
ALONE = estimate(read_battery(FIRST, "drive.csv"), read_config(CONFIG)).document()
"""The first drive, estimated without the service."""


def day(number: int) -> str:
    """Return when the drive of a day began."""
    return (BEGAN + timedelta(days=number)).isoformat()


def history(bench: Bench, path: str) -> list[dict[str, Any]]:
    """Return all estimates in the order of time."""
    items: list[dict[str, Any]] = bench.ask("GET", f"{path}/estimates")["items"]
    return items[::-1]


def test_a_file_is_estimated_by_a_job_and_the_answer_is_that_of_the_command(bench: Bench) -> None:
    path = bench.make()
    sent = bench.send(path, FIRST, began_at=day(0))
    assert (sent["job"]["kind"], sent["job"]["battery_id"], sent["duplicate"]) == ("battery", path[1:], False)
    assert (sent["file"]["name"], sent["file"]["state"], sent["file"]["size"]) == ("drive.csv", "queued", len(FIRST))
    assert bench.work(sent["job"]["id"]) == "succeeded"
    battery = bench.ask("GET", path)
    newest = battery["newest"]
    assert (newest["began_at"], newest["ended_at"]) == ("2026-03-01T08:00:00Z", "2026-03-01T08:29:59Z")
    for name in ("capacity_ah", "soc", "soh_sd", "resistance_ohm", "current_bias_a_sd", "voltage_rms_v"):
        assert newest[name] == pytest.approx(ALONE[name], rel=1e-12)
    assert newest["soh"] == pytest.approx(2.0 / 2.2, abs=3.0 * newest["soh_sd"])
    answer = bench.ask("GET", f"{path}/estimates/{newest['id']}")
    assert answer.keys() >= ALONE.keys() | {"provenance"}
    assert answer["history"]["soc"] == ALONE["history"]["soc"]
    assert answer["provenance"]["code_version"] == bench.resources.settings.code_version
    assert (answer["provenance"]["config_revision"], answer["provenance"]["carried_over"]) == (2, False)
    kept = bench.client.get(f"/api/v1/batteries{path}/data/{sent['file']['id']}")
    assert kept.content == FIRST


def test_the_same_bytes_are_answered_with_the_estimate_that_is_there(bench: Bench) -> None:
    path = bench.make()
    first = bench.send(path, FIRST)
    again = bench.send(path, FIRST)
    assert (again["job"]["id"], again["duplicate"], again["estimate"]) == (first["job"]["id"], True, None)
    bench.work_all()
    there = bench.send(path, FIRST, filename="other name.csv")
    assert (there["job"], there["file"]["id"]) == (None, first["file"]["id"])
    assert there["estimate"]["id"] == history(bench, path)[0]["id"]


def test_an_estimate_begins_with_what_the_one_before_it_knew(bench: Bench) -> None:
    path = bench.make()
    for number, data in enumerate((FIRST, SECOND)):
        bench.send(path, data, began_at=day(number))
    assert bench.work_all() == ["succeeded", "succeeded"]
    one, two = history(bench, path)
    assert (one["follows_id"], two["follows_id"]) == (None, one["id"])
    assert two["capacity_ah_sd"] < one["capacity_ah_sd"]
    assert two["capacity_ah"] == pytest.approx(2.0, abs=3.0 * two["capacity_ah_sd"])


def test_one_that_comes_late_is_put_in_its_place(bench: Bench) -> None:
    """Whatever the order they come in, the history is the one of the order they were driven in."""
    path = bench.make()
    bench.send(path, SECOND, began_at=day(1))
    bench.work_all()
    bench.send(path, FIRST, began_at=day(0))
    assert bench.work_all() == ["succeeded", "succeeded"]  # the late one, and all that follow it again
    late = history(bench, path)
    assert (late[0]["follows_id"], late[1]["follows_id"]) == (None, late[0]["id"])
    kept = [estimate["made_at"] for estimate in late]
    job = bench.ask("POST", f"{path}/reestimate", 202)
    assert bench.work(job["id"]) == "succeeded"
    assert [estimate["made_at"] for estimate in history(bench, path)] == kept  # the very same is not done twice
    other = bench.client.post("/api/v1/cars", json={"name": "twin"}).json()["id"]
    twin = f"/{bench.ask('POST', '', 201, json={'car_id': other, 'config': CONFIG})['id']}"
    for number, data in enumerate((FIRST, SECOND)):
        bench.send(twin, data, began_at=day(number))
    bench.work_all()
    for mine, its in zip(late, history(bench, twin), strict=True):
        assert mine["capacity_ah"] == pytest.approx(its["capacity_ah"], rel=1e-12)


def test_where_the_time_between_is_not_known_nor_is_the_charge(bench: Bench) -> None:
    """Each drive began at 70 %, though the one before ended elsewhere: a charge between them that nobody saw."""
    path = bench.make()
    for data in (FIRST, SECOND):
        bench.send(path, data)
        bench.work_all()
    bench.send(path, table(3, 0.5), began_at=day(0))
    bench.work_all()
    for one in history(bench, path):
        assert one["warnings"] == []
        assert one["capacity_ah"] == pytest.approx(2.0, abs=3.0 * one["capacity_ah_sd"])


def test_two_that_began_at_the_same_moment_have_an_order(bench: Bench) -> None:
    path = bench.make()
    for data in (FIRST, SECOND):
        bench.send(path, data, began_at=day(0))
    bench.work_all()
    made = [one["made_at"] for one in history(bench, path)]
    assert sorted(one["follows_id"] is None for one in history(bench, path)) == [False, True]
    bench.ask("POST", f"{path}/reestimate", 202)
    assert bench.work_all() == ["succeeded"]
    assert [one["made_at"] for one in history(bench, path)] == made


def test_another_configuration_begins_anew_when_everything_is_estimated_again(bench: Bench) -> None:
    path = bench.make()
    for number, data in enumerate((FIRST, SECOND)):
        bench.send(path, data, began_at=day(number))
    bench.work_all()
    before = history(bench, path)
    bench.ask("PUT", f"{path}/config", json=TRUTH | {"estimator": "ekf"})
    assert history(bench, path) == before
    bench.ask("POST", f"{path}/reestimate", 202)
    assert bench.work_all() == ["succeeded"]
    after = history(bench, path)
    assert [one["estimator"] for one in after] == ["ekf", "ekf"]
    assert [one["id"] for one in after] == [one["id"] for one in before]
    assert after[0]["capacity_ah"] != before[0]["capacity_ah"]


def test_a_form_with_a_packed_file_will_do(bench: Bench) -> None:
    path = bench.make()
    files = {"file": ("../evening drive.csv.gz", gzip.compress(FIRST), "application/gzip")}
    sent = bench.ask("POST", f"{path}/data", 202, files=files)
    assert sent["file"]["name"] == "evening drive.csv.gz"
    assert bench.work_all() == ["succeeded"]
    (one,) = history(bench, path)
    assert one["capacity_ah"] == pytest.approx(ALONE["capacity_ah"], rel=1e-12)
    assert one["began_at"] == one["ended_at"] == sent["file"]["created_at"]  # nobody knows when it was


def test_a_file_is_waited_for(bench: Bench) -> None:
    def worker() -> None:
        end = time.monotonic() + 20.0
        while time.monotonic() < end and not bench.work_all():
            time.sleep(0.01)

    path = bench.make()
    for data, status in ((FIRST, 202), (b"t_s,current_a\n0,1\n1,2\n", 422)):
        playing = threading.Thread(target=worker)
        playing.start()
        told = bench.send(path, data, status, wait=20)
        playing.join()
        if status == 202:
            assert (told["job"]["state"], told["estimate"]["soh"]) == ("succeeded", pytest.approx(ALONE["soh"]))
        else:
            assert "voltage" in told["detail"]
    assert bench.send(path, SECOND, wait=0.1)["job"]["state"] == "queued"


def test_a_webhook_is_told_once_of_each_estimate(bench: Bench) -> None:
    wanted = {"url": "http://localhost:9/", "events": ["battery.ready"]}
    hook = bench.client.post("/api/v1/webhooks", json=wanted).json()["id"]
    path = bench.make()
    for number, data in ((1, SECOND), (0, FIRST)):
        bench.send(path, data, began_at=day(number))
        bench.work_all()
    told = [one["payload"]["data"] for one in bench.client.get(f"/api/v1/webhooks/{hook}/deliveries").json()["items"]]
    assert [one["id"] for one in told] == [one["id"] for one in history(bench, path)]  # the newest delivery first
    assert (told[0]["car_id"], told[0]["name"]) == (bench.car_id, "Battery of hybrid")
    assert told[0]["soh"] == pytest.approx(ALONE["soh"], rel=1e-12)


def test_a_job_is_cancelled_on_its_way(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    path = bench.make()
    job = bench.send(path, FIRST)["job"]["id"]
    whole = working.answer

    def slow(asked: Question, progress: Progress) -> Any:
        bench.client.post(f"/api/v1/jobs/{job}/cancel")
        time.sleep(1.1 * PROGRESS_EVERY_S)
        return whole(asked, progress)

    monkeypatch.setattr(working, "answer", slow)
    assert bench.work(job) == "cancelled"
    assert history(bench, path) == []
    assert bench.ask("GET", f"{path}/data")["items"][0]["state"] == "cancelled"


def test_bad_files_are_refused_or_end_as_failed_jobs_with_the_reason(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = bench.make()
    assert bench.send(path, b"", 422)["code"] == "empty-file"
    assert bench.ask("POST", f"{path}/data", 422, files={"note": (None, "no file")})["code"] == "no-file"
    two = [("file", ("a.csv", FIRST)), ("file", ("b.csv", SECOND))]
    assert bench.ask("POST", f"{path}/data", 422, files=two)["code"] == "bad-form"
    for more in ({"content": FIRST}, {"files": {"file": ("a.csv", FIRST)}}):
        with monkeypatch.context() as smaller:
            smaller.setattr(receiving, "LARGEST_FILE_BYTES", 1000)
            assert bench.ask("POST", f"{path}/data", 413, **more)["code"] == "file-too-large"
    assert bench.send(path, FIRST, 422, began_at="at noon")["field"] == "query.began_at"
    for data, words in ((b"\x00\x01garbage", ""), (b"t_s,current_a\n0,1\n1,2\n", "voltage")):
        sent = bench.send(path, data)
        assert bench.work(sent["job"]["id"]) == "failed"
        (file,) = [one for one in bench.ask("GET", f"{path}/data")["items"] if one["id"] == sent["file"]["id"]]
        assert (file["state"], file["problem"]["status"], file["estimate_id"]) == ("failed", 422, None)
        assert words in file["problem"]["detail"]
    assert history(bench, path) == []


def test_removing_a_file_removes_what_it_said_and_mends_the_rest(bench: Bench) -> None:
    path = bench.make()
    first = bench.send(path, FIRST, began_at=day(0))["file"]["id"]
    bench.send(path, SECOND, began_at=day(1))
    bench.work_all()
    bench.ask("DELETE", f"{path}/data/{first}", 204)
    assert bench.work_all() == ["succeeded"]
    (left,) = history(bench, path)
    assert left["follows_id"] is None
    bench.ask("GET", f"{path}/data/{first}", 404)
    service.sweep(bench.resources, FLEET)
    keys = bench.resources.blobs.keys(battery_folder(FLEET, path[1:]))
    assert len(keys) == 2  # a file that was sent, and its answer
    assert not [key for key in keys if first in key]
    bench.ask("DELETE", path, 204)
    service.sweep(bench.resources, FLEET)
    assert bench.resources.blobs.keys(battery_folder(FLEET, path[1:])) == []


def test_history_and_estimates_are_saved_and_drawn(bench: Bench) -> None:
    path = bench.make()
    bench.send(path, FIRST, began_at=day(0), filename="=cmd().csv")
    bench.work_all()
    (one,) = history(bench, path)
    url = f"/api/v1/batteries{path}"
    rows = list(csv.DictReader(io.StringIO(bench.client.get(f"{url}/export?format=csv").text)))
    assert float(rows[0]["capacity_ah"]) == one["capacity_ah"]
    assert rows[0]["source"] == "'=cmd().csv"
    whole = pq.read_table(io.BytesIO(bench.client.get(f"{url}/export?format=parquet").content))
    assert whole["soh_sd"].to_pylist() == [one["soh_sd"]]
    assert bench.client.get(f"{url}/export").json()["estimates"][0]["id"] == one["id"]
    single = f"{url}/estimates/{one['id']}/export"
    over_time = pq.read_table(io.BytesIO(bench.client.get(f"{single}?format=parquet").content))
    assert over_time["soc"].to_pylist() == ALONE["history"]["soc"]
    assert len(bench.client.get(f"{single}?format=csv").text.splitlines()) == over_time.num_rows + 1
    for name in ("soc", "soh", "parameters", "residual", "curve", "ageing", "current"):
        drawn = bench.ask("GET", f"{path}/figures/{name}", params={"estimate": one["id"], "threshold": 0.7})
        assert drawn["data"], name
    bench.ask("GET", f"{path}/figures/soc", 404, params={"estimate": "0" * 32})


def test_a_curve_is_fitted_and_may_stand_in_the_configuration(bench: Bench) -> None:
    path = bench.make()
    assert bench.ask("GET", f"{path}/curve", 409)["code"] == "no-curve"
    sent = bench.ask("POST", f"{path}/curve", 202, content=sweep_table(), params={"filename": "slow.csv"})
    assert bench.ask("GET", f"{path}/curve", 409)["code"] == "curve-not-ready"
    assert bench.work(sent["job"]["id"]) == "succeeded"
    fitted = bench.ask("GET", f"{path}/curve")
    assert fitted["capacity_ah"] == pytest.approx(2.0, rel=0.01)
    (middle,) = [volts for soc, volts in fitted["ocv"] if abs(soc - 0.6) < 1e-6]
    assert middle == pytest.approx(3.6, abs=0.01)
    assert bench.ask("PUT", f"{path}/config", json=CONFIG | {"ocv": fitted["ocv"]})["ocv"] == fitted["ocv"]
    wanted = {"polynomial": 6, "also": sent["file"]["id"]}
    again = bench.ask("POST", f"{path}/curve", 202, content=sweep_table(), params=wanted)
    assert bench.work(again["job"]["id"]) == "succeeded"
    assert len(bench.ask("GET", f"{path}/curve")["ocv"]) == 7
    bench.ask("POST", f"{path}/curve", 404, content=b"x", params={"also": "0" * 32})
    assert history(bench, path) == []


def sweep_table() -> bytes:
    """Return a slow discharge from full to empty and a charge back."""
    import numpy as np

    from app.science.battery.simulate import simulate

    t_s = np.arange(0.0, 22.0 * 3600.0, 60.0)
    current = np.where(t_s < 10.0 * 3600.0, -0.2, np.where(t_s < 11.0 * 3600.0, 0.0, 0.2))
    current[t_s >= 21.0 * 3600.0] = 0.0
    cell = read_config(TRUTH | {"initial": TRUTH["initial"] | {"soc": 1.0}}).cell
    rows = np.column_stack([t_s, current, simulate(cell, t_s, current).voltage_v])
    sink = io.StringIO()
    np.savetxt(sink, rows, fmt="%.8g", delimiter=",", header="t_s,current_a,voltage_v", comments="")
    return sink.getvalue().encode()
