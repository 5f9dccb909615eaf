"""What posing a problem refuses."""

from __future__ import annotations

from app.science.errors import ScienceError


class PoseError(ScienceError):
    """A car or a road can't be made into a problem; the message says what is missing and what to do."""

    code = "can-not-be-posed"
