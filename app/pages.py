"""Pages that belong to no slice: the overview and the settings, and the files all pages need."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app import static_files
from app.templating import render

router = APIRouter(include_in_schema=False)
router.include_router(static_files.router)


@router.get("/")
def overview_page(request: Request) -> Response:
    """Show what to do first, or what happened last."""
    return render(request, "overview.html")


@router.get("/settings")
def settings_page(request: Request) -> Response:
    """Show the session, access tokens, elevation tables, the map's tiles and the theme."""
    return render(request, "settings.html")
