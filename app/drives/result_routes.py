"""What was worked out about drives over REST: answers, comparisons, fronts, figures, files."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import attachment, large_json
from app.drives import service
from app.drives.drawing import Wish, draw
from app.drives.exporting import FORMATS, FormatName, export
from app.drives.models import Drive, Work
from app.drives.results import document_of
from app.edge import OpenResources, ReadSession
from app.figures.drive import FigureName
from app.schemas import Id

router = APIRouter(prefix="/drives/{drive_id}", tags=["drives"])

ThemeName = Literal["light", "dark"]


def the_drive(session: ReadSession, drive_id: Id) -> Drive:
    """Return the drive of the address with its documents."""
    return service.row(session, drive_id, whole=True)


TheDrive = Annotated[Drive, Depends(the_drive)]


@router.get("/answer", response_model=dict[str, Any])
def show_answer(request: Request, session: ReadSession, opened: OpenResources, found: TheDrive) -> Response:
    """Give the answer as `./ponthy drive --json` does; 409 while there is none, 422 when there can be none."""
    return large_json(request, document_of(session, opened.blobs, found, Work.SOLVE))


@router.get("/comparison", response_model=dict[str, Any])
def show_comparison(request: Request, session: ReadSession, opened: OpenResources, found: TheDrive) -> Response:
    """Give the newest comparison of methods."""
    return large_json(request, document_of(session, opened.blobs, found, Work.COMPARE))


@router.get("/front", response_model=dict[str, Any])
def show_front(request: Request, session: ReadSession, opened: OpenResources, found: TheDrive) -> Response:
    """Give the newest front of fuel against an emission."""
    return large_json(request, document_of(session, opened.blobs, found, Work.FRONT))


@router.get("/figures/{name}", response_model=dict[str, Any])
def draw_drive(
    request: Request,
    session: ReadSession,
    opened: OpenResources,
    found: TheDrive,
    name: FigureName,
    wish: Annotated[Wish, Depends()],
) -> Response:
    """Give a figure of the answer as Plotly draws it."""
    return large_json(request, draw(session, opened.blobs, found, name, wish))


@router.get("/export", response_class=Response)
def save_drive(
    session: ReadSession,
    opened: OpenResources,
    found: TheDrive,
    form: Annotated[FormatName, Query(alias="format")] = "json",
) -> Response:
    """Give a drive as a file: its answer, its trajectory as a table, or the problem that `./ponthy drive` takes."""
    data = export(session, opened.blobs, found, form)
    return attachment(data, f"{found.name}{FORMATS[form].ending}", FORMATS[form].media_type)
