"""Two maps beside each other over REST."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import large_json
from app.edge import OpenResources, ReadSession
from app.maps import comparing
from app.schemas import Id

router = APIRouter(prefix="/cars/{car_id}/maps/compare", tags=["maps"])

WHICH = (
    "A version (`3`, `latest`) or a period (`2026-03-01..2026-06-30`, either end may be left out); another car's after "
    "its identifier and a colon."
)
Choice = Annotated[str, Query(max_length=80, description=WHICH, examples=["3", "2026-03-01..2026-06-30"])]


def the_comparison(
    session: ReadSession, opened: OpenResources, car_id: Id, first: Choice, second: Choice = "latest"
) -> comparing.Comparison:
    """Return the comparison of the query."""
    return comparing.compare(session, opened.blobs, car_id, first, second)


TheComparison = Annotated[comparing.Comparison, Depends(the_comparison)]


@router.get("", response_model=dict[str, Any])
def compare_maps(request: Request, found: TheComparison) -> Response:
    """Tell what is different between two versions, two cars or two periods, cell by cell, and what may be chance."""
    return large_json(request, comparing.document(found))


@router.get("/figures/difference", response_model=dict[str, Any])
def draw_difference(request: Request, found: TheComparison, theme: Literal["light", "dark"] = "light") -> Response:
    """Give the difference as Plotly draws it: strong where it is more than chance."""
    return large_json(request, comparing.draw(found, theme))
