"""The report's runs and figures over REST."""

from __future__ import annotations

from typing import Any, Literal

from fastapi import APIRouter, Request, Response

from app.answers import large_json
from app.batteries.reporting import ask_for_report, report_of
from app.edge import OpenResources, ReadSession, WriteSession
from app.figures.battery_report import ReportFigure, report_figure
from app.figures.theme import theme_named
from app.jobs.service import JobView

router = APIRouter(prefix="/batteries/report", tags=["batteries"])


@router.post("", status_code=202)
def make_report(session: WriteSession, opened: OpenResources) -> JobView:
    """Make the runs of MAUTC-2010-02, part 3, on our virtual pack; those this program made already serve again."""
    return ask_for_report(session, opened.settings.code_version)


@router.get("", response_model=dict[str, Any])
def show_report(request: Request, session: ReadSession, opened: OpenResources) -> Response:
    """Give the newest runs as data: current, cycles, estimates beside the truth, degradation map."""
    return large_json(request, report_of(session, opened.blobs))


@router.get("/figures/{number}", response_model=dict[str, Any])
def draw_report(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    number: ReportFigure,
    theme: Literal["light", "dark"] = "light",
) -> Response:
    """Give a figure of the report, by its number there, redrawn from our runs."""
    return large_json(request, report_figure(number, report_of(session, opened.blobs), theme=theme_named(theme)))
