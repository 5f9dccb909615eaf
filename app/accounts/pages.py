"""Page that signs a person in."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.templating import render

router = APIRouter(include_in_schema=False)


@router.get("/login")
def login_page(request: Request) -> Response:
    """Ask for e-mail address and password."""
    return render(request, "login.html")
