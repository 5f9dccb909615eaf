"""The doors of the house are locked: a copy of the sources that breaks each of them is refused."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SLICES = {"accounts", "cars", "uploads", "trips", "jobs", "maps", "roads", "webhooks", "health", "drives", "eco"}
SLICES |= {"batteries"}
NOT_SLICES = {"cli", "exports", "figures", "imports", "science", "storage"}

BREACHES = {
    "Door 1: science imports nothing of delivery": [
        ("app/science/arrays.py", "app.settings"),
        ("app/science/vehicle/model.py", "sqlalchemy"),
    ],
    "Door 1: inside science, upper floors stand on lower ones": [
        ("app/science/logger/recording.py", "app.science.observer.states"),
        ("app/science/observer/states.py", "app.science.engine.points"),
        ("app/science/errors.py", "app.science.vehicle.model"),
    ],
    "Door 1: the virtual car shares no code with what is tested against it": [
        ("app/science/virtualcar/__init__.py", "app.science.logger.recording"),
    ],
    "Door 2: figures, exports and imports know science only": [
        ("app/figures/__init__.py", "app.storage.base"),
        ("app/exports/__init__.py", "app.imports"),
        ("app/imports/__init__.py", "fastapi"),
    ],
    "Door 3: storage knows neither slices nor web": [
        ("app/storage/base.py", "app.cars.models"),
        ("app/storage/blobs.py", "starlette"),
    ],
    "Door 5: app enqueues by task name and never imports workers": [("app/errors.py", "workers")],
} | {
    f"Door 4: {name} is entered through its service": [(f"app/{other}/models.py", f"app.{name}.models")]
    for name, other in zip(sorted(SLICES), sorted(SLICES)[1:] + sorted(SLICES)[:1], strict=True)
}


def lint(root: Path) -> str:
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as c; c()", "--no-cache"]
    environment = {**os.environ, "PYTHONPATH": str(root), "COLUMNS": "200"}
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, check=False)
    assert "Contracts: " in done.stdout, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def broken_report(tmp_path_factory: pytest.TempPathFactory) -> str:
    copy = tmp_path_factory.mktemp("copy")
    shutil.copy(ROOT / "pyproject.toml", copy)
    for package in ("app", "workers"):
        shutil.copytree(ROOT / package, copy / package, ignore=shutil.ignore_patterns("__pycache__"))
    for path, imported in (breach for breaches in BREACHES.values() for breach in breaches):
        with (copy / path).open("a") as file:
            file.write(f"\nimport {imported}\n")
    return lint(copy)


def test_the_sources_pass_every_door() -> None:
    assert re.search(r"Contracts: \d+ kept, 0 broken", lint(ROOT))


def test_every_door_is_broken_on_purpose() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    assert {contract["name"] for contract in contracts} == set(BREACHES)


@pytest.mark.parametrize("door", BREACHES)
def test_a_breach_is_noticed(door: str, broken_report: str) -> None:
    assert f"{door} BROKEN" in broken_report
    details = broken_report.split(f"\n{door}\n-", 1)[1].split("\nDoor ")[0]
    for path, imported in BREACHES[door]:
        importer = path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        assert re.search(rf"{re.escape(importer)} -> {re.escape(imported)}\b", details), details


def test_every_package_has_its_door() -> None:
    """A new package of app is either a slice, with a contract of its own, or one of the known rooms."""
    packages = {path.parent.name for path in (ROOT / "app").glob("*/__init__.py")}
    assert packages == SLICES | NOT_SLICES
