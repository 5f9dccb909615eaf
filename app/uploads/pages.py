"""Page that takes files."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/upload")
def upload_page(request: Request) -> Response:
    """Take logger images, signals tables, elevation tables and car files."""
    return render(request, "upload.html")
