"""SQL of the scores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Select, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from app.eco.models import TripScoreRow
from app.storage.locks import row_lock
from app.storage.paging import Page, greatest_first


@dataclass(frozen=True, slots=True)
class Sums:
    """What the scores of some trips add up to.

    ``saved_sd_l`` is the sum of the trips' deviations: they share the car's map, so their errors go together.
    """

    of: str
    trips: int
    fuel_l: float
    saved_l: float
    saved_sd_l: float
    distance_m: float

    @property
    def score(self) -> float:
        """100 where nothing was left to save; trips weigh as much as their fuel."""
        return 100.0 * (1.0 - self.saved_l / self.fuel_l)

    @property
    def score_sd(self) -> float:
        """Standard deviation of the score."""
        return 100.0 * self.saved_sd_l / self.fuel_l


def row(session: Session, trip_id: str, *, lock: bool = False) -> TripScoreRow | None:
    """Return the newest score of a trip; with ``lock`` nobody else changes it until the transaction ends."""
    return session.get(TripScoreRow, trip_id, with_for_update=row_lock(lock), populate_existing=lock)


def of_car(session: Session, car_id: str) -> Sequence[TripScoreRow]:
    """Return the scores of a car's trips, in no order."""
    return session.scalars(select(TripScoreRow).where(TripScoreRow.car_id == car_id)).all()


def of_trips(session: Session, trip_ids: Sequence[str]) -> Sequence[TripScoreRow]:
    """Return the scores of trips, in no order."""
    return session.scalars(select(TripScoreRow).where(TripScoreRow.trip_id.in_(trip_ids))).all()


def sums_of_car(session: Session, car_id: str) -> Sums | None:
    """Return what a car's scored trips add up to; None without any."""
    mine = _sums(TripScoreRow.car_id).where(TripScoreRow.car_id == car_id)
    found = session.execute(mine).first()
    return None if found is None else _read(found, car_id)


def ranking(session: Session, by: str, cursor: str | None, limit: int) -> Page[Sums]:
    """Return one page of cars or trips, the best driven first."""
    identifier = TripScoreRow.car_id if by == "car" else TripScoreRow.trip_id
    page = greatest_first(session, _sums(identifier), -_share(), identifier, cursor, limit)
    return Page([_read(found, found.ranked_id) for found in page.items], page.next_cursor)


def _sums(identifier: InstrumentedAttribute[str]) -> Select[Any]:
    summed = ("fuel_l", "saved_l", "saved_sd_l", "distance_m")
    columns: list[Any] = [func.sum(getattr(TripScoreRow, name)).label(name) for name in summed]
    scored = TripScoreRow.score.is_not(None)
    return select(func.count().label("trips"), *columns).where(scored).group_by(identifier)


def _share() -> ColumnElement[Any]:
    """Share of the fuel that could have been saved."""
    return func.sum(TripScoreRow.saved_l) / func.sum(TripScoreRow.fuel_l)


def _read(found: Any, of: str) -> Sums:
    return Sums(of, found.trips, found.fuel_l, found.saved_l, found.saved_sd_l, found.distance_m)
