"""Solved problems that figures of drives are drawn of."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from app.figures.drive_documents import DrawnDrive, drawn_drive
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from tests.science.optimal.documents import thesis

BALL: dict[str, Any] = {"kind": "ball_and_wheel", "x1": 1.0, "x2": 0.5, "u_min": -1.0, "u_max": 1.5, "gamma": 0.7}


def solved(problem: dict[str, Any], name: str = "this drive") -> DrawnDrive:
    """Solve a problem and make it ready to be drawn, by way of JSON as in the service."""
    answer = json.loads(json.dumps(solve(read_problem(problem)).document()))
    return drawn_drive(answer, problem, name=name)


@cache
def acceleration() -> DrawnDrive:
    """The thesis' car from 36 to 100 km/h in six gears."""
    return solved(thesis(), "six gears")


@cache
def hurried() -> DrawnDrive:
    """The same in eight seconds."""
    return solved(thesis(time_s=8.0), "eight seconds")


@cache
def ball() -> DrawnDrive:
    """The ball on the wheel."""
    return solved(BALL)
