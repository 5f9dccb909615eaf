"""Figures of a drive, made on request from its stored results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import Query
from sqlalchemy.orm import Session

from app.drives import repository
from app.drives.models import Drive, Work
from app.drives.posing import resolved
from app.drives.results import document_of
from app.errors import NotFound, PonthyError
from app.figures.drive import FigureName, drive_figure
from app.figures.drive_documents import DrawnDrive, drawn_drive
from app.figures.theme import Json, theme_named
from app.storage.blobs import Blobs


@dataclass(frozen=True, slots=True)
class Wish:
    """What of a figure can be chosen.

    Attributes
    ----------
    over : {"time", "distance"}
        What panels are drawn over.
    other : str or None
        Another drive that is laid over this one.
    theme : {"light", "dark"}
    """

    over: Literal["time", "distance"] = "time"
    other: Annotated[str | None, Query(pattern="^[0-9a-f]{32}$", description="A drive to lay over this one.")] = None
    theme: Literal["light", "dark"] = "light"


def draw(session: Session, blobs: Blobs, drive: Drive, name: FigureName, wish: Wish) -> Json:
    """Return a figure; raises `PonthyError` when a drive in it has no answer yet."""
    this = _drawn(session, blobs, drive)
    other = None if wish.other is None else _drawn(session, blobs, _other(session, wish.other))
    return drive_figure(name, this, over=wish.over, other=other, theme=theme_named(wish.theme))


def _other(session: Session, drive_id: str) -> Drive:
    found = repository.drive(session, drive_id, whole=True)
    if found is None:
        raise NotFound("drive", drive_id)
    return found


def _drawn(session: Session, blobs: Blobs, drive: Drive) -> DrawnDrive:
    answer = document_of(session, blobs, drive, Work.SOLVE)
    comparison, front = (_optional(session, blobs, drive, work) for work in (Work.COMPARE, Work.FRONT))
    problem = resolved(drive.problem, drive.engine)
    return drawn_drive(answer, problem, name=drive.name, comparison=comparison, front=front)


def _optional(session: Session, blobs: Blobs, drive: Drive, work: Work) -> dict[str, Any] | None:
    try:
        return document_of(session, blobs, drive, work)
    except PonthyError:  # nobody asked, or it isn't ready: the figure does without
        return None
