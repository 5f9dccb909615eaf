"""What has to start fast stays light: a fresh interpreter tells what it has loaded."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEAVY = {
    "numpy", "scipy", "numba", "pyarrow", "pyproj", "plotly", "matplotlib", "celery", "kombu", "sqlalchemy",
    "fastapi", "starlette", "pydantic", "lxml", "obstore",
}  # fmt: skip


@pytest.mark.parametrize(
    ("module", "forbidden"),
    [
        ("app.cli.main", HEAVY),
        ("app.errors", HEAVY),
        ("app.science.logger.recording", HEAVY - {"numpy"}),
        ("app.science.observer.result", HEAVY - {"numpy"}),
        ("app.main", {"matplotlib", "numba", "scipy"}),
        ("workers.web", {"matplotlib", "numba", "scipy"}),
        ("workers.celery_app", {"matplotlib"}),
    ],
)
def test_loads_nothing_heavy(module: str, forbidden: set[str]) -> None:
    program = f"import sys, {module}; print(*{{name.split('.')[0] for name in sys.modules}})"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) & forbidden == set()
