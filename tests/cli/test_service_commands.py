"""Commands on the service's data, and on a running service."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from app.cli.bench.uploading import car_xml, web_server
from app.cli.main import main
from app.cli.tus import Service
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

Capture = pytest.CaptureFixture[str]
Call = Callable[..., Any]


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> Call:
    """Run a command on data of its own; return what it printed as JSON, or the line of its failure."""
    monkeypatch.setenv("PONTHY_DATA_DIR", str(tmp_path / "data"))

    def run(*words: str, status: int = 0, typed: str = "") -> Any:
        monkeypatch.setattr("sys.stdin", io.StringIO(typed))
        capsys.readouterr()
        assert main([*words]) == status, capsys.readouterr().err
        said = capsys.readouterr()
        if status:
            assert said.err.count("\n") == 1
            return said.err
        return json.loads(said.out) if "--json" in words else said.out

    return run


def test_people_join_fleets(call: Call) -> None:
    first = call("user", "add", "anna@example.org", "--password-stdin", "--json", typed="a long password\n")
    second = call(
        "user", "add", "ben@example.org", "--password-stdin", "--new-fleet", "Vans", "--json", typed="a long password\n"
    )
    third = call(
        "user", "add", "eve@example.org", "--password-stdin", "--fleet", "Vans", "--json", typed="a long password\n"
    )
    assert (first["name"], first["fleet_id"] != second["fleet_id"]) == ("anna", True)
    assert second["fleet_id"] == third["fleet_id"]
    again = ("user", "add", "ANNA@example.org", "--password-stdin")
    assert "exists already" in call(*again, status=1, typed="a long password\n")
    assert "too short" in call("user", "add", "x@example.org", "--password-stdin", status=1, typed="short\n")
    taken = ("user", "add", "x@example.org", "--password-stdin", "--new-fleet", "Vans")
    assert "called 'Vans' already" in call(*taken, status=1, typed="a long password\n")
    nowhere = ("user", "add", "x@example.org", "--password-stdin", "--fleet", "Nowhere")
    assert "no fleet 'Nowhere'" in call(*nowhere, status=1, typed="a long password\n")


def test_tokens_are_made_listed_and_revoked(call: Call) -> None:
    made = call("token", "create", "night import", "--read-only", "--json")
    assert made["token"].startswith(f"ponthy_{made['token'].split('_')[1]}_")
    (listed,) = call("token", "list", "--json")["items"]
    assert (listed["id"], listed["name"], listed["scope"]) == (made["id"], "night import", "read")
    assert made["token"] not in json.dumps(listed)
    call("token", "revoke", made["id"])
    assert call("token", "list", "--json") == {"items": []}
    assert "no token" in call("token", "revoke", made["id"], status=1)


def test_a_restored_backup_is_the_same_service(call: Call, tmp_path: Path) -> None:
    made = call("token", "create", "kept", "--json")
    archive = str(tmp_path / "backup.tar")
    assert call("backup", archive, "--json")["files"] == 0
    call("restore", archive, "--data", str(tmp_path / "other"))
    (kept,) = call("token", "list", "--data", str(tmp_path / "other"), "--json")["items"]
    assert kept["id"] == made["id"]
    assert "empty data folder" in call("restore", archive, "--data", str(tmp_path / "other"), status=1)


def test_reprocessing_names_what_is_unknown(call: Call) -> None:
    assert call("reprocess", "--json") == {"job_ids": []}
    assert "no car" in call("reprocess", "f" * 32, status=1)


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    """A web server without a worker."""
    with web_server(tmp_path / "served") as (service, _):
        yield service


def test_files_go_to_a_running_service(service: Service, call: Call, tmp_path: Path) -> None:
    made = service.request("POST", "/api/v1/cars", body=car_xml(), headers={"Content-Type": "application/xml"}).json()
    folder = tmp_path / "card"
    folder.mkdir()
    for seed in (1, 2):
        (folder / f"{seed}.dat").write_bytes(simulate(Simulation(duration_s=60.0, seed=seed)).image)
    (folder / ".hidden").write_text("not sent")
    to = ("--car", made["id"], "--url", service.url, "--json")

    first = call("upload", str(folder), *to)["uploads"]
    again = call("upload", str(folder / "1.dat"), *to)["uploads"]

    assert [one["filename"] for one in first] == ["1.dat", "2.dat"]
    assert [one["duplicate"] for one in (*first, *again)] == [False, False, True]
    assert again[0]["trip_ids"] == first[0]["trip_ids"]
    trip = first[0]["trip_ids"][0]
    assert "HTTP 409" in call("export", "--trip", trip, "--format", "kmz", "--url", service.url, status=1)
    assert "HTTP 404" in call("export", "--car", "f" * 32, "--url", service.url, status=1)
    assert "doesn't answer" in call("export", "--trip", trip, "--url", "http://127.0.0.1:9", status=1)
    assert "either --trip or --car" in call("export", "--url", service.url, status=2)
