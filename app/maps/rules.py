"""Which of a car's trips count in its map."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any, Literal

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.jobs import service as jobs
from app.maps import repository
from app.maps.models import MapRules
from app.trips import service as trips

Verdicts = Literal["healthy", "doubtful", "all"]
TorqueSource = Literal["both", "ecu", "observer"]
ENOUGH = {"healthy": {"healthy"}, "doubtful": {"healthy", "doubtful"}}


@dataclass(frozen=True, slots=True)
class Rules:
    """What a trip must be to count, besides not being left out by hand.

    Attributes
    ----------
    verdicts : {"healthy", "doubtful", "all"}
        Healthy trips only, healthy and doubtful ones, or all.
    smoothed_only : bool
        Whether the smoother must have run.
    torque_source : {"both", "ecu", "observer"}
        Where the torque of its points must come from.
    since, until : datetime or None
        It must have begun not before, and before.
    """

    verdicts: Verdicts = "all"
    smoothed_only: bool = False
    torque_source: TorqueSource = "both"
    since: datetime | None = None
    until: datetime | None = None

    def why_not(self, trip: trips.ObservedTrip, torque_source: str) -> str:
        """Return why a trip does not count; empty when it does."""
        if self.verdicts in ENOUGH and trip.verdict not in ENOUGH[self.verdicts]:
            return f"the observer's verdict is {trip.verdict}"
        if self.smoothed_only and not trip.smoothed:
            return "it is not smoothed"
        if self.torque_source not in ("both", torque_source):
            return f"its torque comes from the {torque_source}"
        if self.since is not None and trip.began < self.since:
            return f"it began before {self.since:%Y-%m-%d}"
        if self.until is not None and trip.began >= self.until:
            return f"it began after {self.until:%Y-%m-%d}"
        return ""

    def document(self) -> dict[str, Any]:
        """Return the rules as a map's provenance holds them."""
        moments = {
            name: moment and moment.isoformat() for name, moment in (("since", self.since), ("until", self.until))
        }
        return asdict(self) | moments


def rules_of(session: Session, car_id: str) -> Rules:
    """Return a car's rules."""
    row = repository.rules(session, car_id)
    if row is None:
        return Rules()
    return Rules(row.verdicts, row.smoothed_only, row.torque_source, row.since, row.until)  # type: ignore[arg-type]


def show_rules(session: Session, car_id: str) -> Rules:
    """Return a car's rules; raises `NotFound` when there is no such car."""
    cars.get(session, car_id)
    return rules_of(session, car_id)


def change_rules(session: Session, car_id: str, wanted: dict[str, Any]) -> Rules:
    """Change some of a car's rules and have its map made anew by them; raises `NotFound`.

    Parameters
    ----------
    session : Session
    car_id : str
    wanted : dict
        Fields of `Rules`; what is left out stays.
    """
    cars.config(session, car_id, lock=True)
    before = rules_of(session, car_id)
    after = Rules(**(asdict(before) | wanted))
    if after != before:
        repository.put_rules(session, MapRules(car_id=car_id, **asdict(after)))
        jobs.create_map_job(session, car_id=car_id, title="Map by other rules")
    return after
