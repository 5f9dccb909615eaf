"""Fixtures of the trips' tests."""

from __future__ import annotations

import pytest

from app.storage.resources import Resources
from tests.yards import Yard


@pytest.fixture
def yard(resources: Resources) -> Yard:
    """Return a fleet with a car and a trip."""
    return Yard(resources)
