"""Page of the jobs."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/jobs")
def jobs_page(request: Request) -> Response:
    """Show running and finished jobs, live."""
    return render(request, "jobs.html")
