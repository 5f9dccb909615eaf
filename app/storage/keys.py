"""Names of finished work."""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any


def stage_key(stage: str, **ingredients: Any) -> str:
    """Return the name of a stage's work: a hash over everything that its result depends on."""
    return sha256(json.dumps([stage, ingredients], sort_keys=True).encode()).hexdigest()
