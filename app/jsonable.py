"""Values as any JSON reader takes them."""

from __future__ import annotations

import math
from collections.abc import Mapping


def jsonable(value: object) -> object:
    """Return the value with NaN and infinities as null, and tuples as lists."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): jsonable(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(entry) for entry in value]
    return value
