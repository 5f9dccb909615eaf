"""What every test may use."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

# as in ./ponthy: threads of a matrix library would only wait for each other
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# the first example of a property may compile a kernel; no test here is about time
settings.register_profile("ponthy", deadline=None)
settings.load_profile("ponthy")

pytest_plugins = ["tests.services"]

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def shared_data() -> Callable[[str], Path]:
    """Return a function that finds a folder of real measurements, or skips (in CI: fails) when it is absent."""
    base = Path(os.environ.get("PONTHY_SHARED_DATA", ROOT.parent / "shared" / "data"))

    def find(name: str) -> Path:
        path = base / name
        if path.exists():
            return path
        reason = f"real measurements {name!r} are not on this machine (looked in {base})"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)

    return find


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run the browser last: its driver keeps an event loop running that no other test could start one beside."""
    items.sort(key=lambda item: "e2e" in item.path.parts)
