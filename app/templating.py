"""How every page is rendered: templates carry structure and words, and the page's script asks ``/api/v1`` for data."""

from __future__ import annotations

from pathlib import Path

from fastapi import Request, Response
from fastapi.templating import Jinja2Templates

from app.static_files import asset_url, modules_of, plotly_url

TEMPLATE_DIR = Path(__file__).resolve().parent.parent / "frontend" / "templates"

_templates = Jinja2Templates(directory=TEMPLATE_DIR)
_templates.env.globals.update(asset=asset_url, modules_of=modules_of, plotly_url=plotly_url)


def render(request: Request, template: str, **context: object) -> Response:
    """Render a template of ``frontend/templates`` with the given variables; pages are never kept by the browser."""
    return _templates.TemplateResponse(request, template, context, headers={"Cache-Control": "no-cache"})
