"""``./ponthy test``: all tests that this machine can run."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import typer

ROOT = Path(__file__).resolve().parents[2]


def test(context: typer.Context) -> None:
    """Run all tests this machine can run.

    Says which were skipped and why. Takes pytest's own arguments.
    """
    os.chdir(ROOT)
    python = [sys.executable, "-m", "pytest", *context.args]
    os.execv(sys.executable, python)  # noqa: S606 - pytest takes over this process, its status is ours
