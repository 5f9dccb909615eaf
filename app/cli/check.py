"""``./ponthy test``: all tests that this machine can run."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryFile

import typer

ROOT = Path(__file__).resolve().parents[2]
APART = ("tests/science", "tests/tenancy", "tests/trips", "tests/workers")
"""About half of all test time; they need neither a browser nor what the other half keeps open."""


def test(context: typer.Context) -> None:
    """Run all tests this machine can run.

    Says which were skipped and why. Takes pytest's own arguments. Without any, two halves run side by side where
    there are two processors.
    """
    os.chdir(ROOT)
    pytest = [sys.executable, "-m", "pytest"]
    if context.args or (os.cpu_count() or 1) < 2:
        os.execv(sys.executable, [*pytest, *context.args])  # noqa: S606 - pytest takes over this process, its status is ours
    rest = [*pytest, *(f"--ignore={folder}" for folder in APART)]
    raise typer.Exit(side_by_side(rest, [*pytest, *APART]))


def side_by_side(first: list[str], second: list[str]) -> int:
    """Run two commands at once and return the worse status; what the second one says is told when both are done."""
    with TemporaryFile() as kept:
        beside = subprocess.Popen(second, stdout=kept, stderr=subprocess.STDOUT)  # noqa: S603 - our own tests
        status = subprocess.run(first, check=False).returncode  # noqa: S603 - our own tests
        worse = max(abs(status), abs(beside.wait()))
        kept.seek(0)
        shutil.copyfileobj(kept, sys.stdout.buffer)
        sys.stdout.buffer.flush()
    return worse
