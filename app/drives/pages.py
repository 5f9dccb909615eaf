"""Pages of the drives."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.drives import service
from app.edge import PageSession
from app.schemas import Id
from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/drives")
def drives_page(request: Request) -> Response:
    """List the drives."""
    return render(request, "drives.html")


@router.get("/drives/new")
def new_drive_page(request: Request) -> Response:
    """Pose a drive: for a car with its map, or free."""
    return render(request, "drive_new.html")


@router.get("/drives/compare")
def compare_drives_page(request: Request) -> Response:
    """Show two drives side by side."""
    return render(request, "drives_compare.html")


@router.get("/drives/{drive_id}")
def drive_page(request: Request, session: PageSession, drive_id: Id) -> Response:
    """Show one drive: what to do, what it takes, and how one knows."""
    if session is not None:
        service.get(session, drive_id)
    return render(request, "drive.html", drive_id=drive_id)
