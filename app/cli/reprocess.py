"""``./ponthy reprocess``: trips through the pipeline again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.options import AsJson, Data, FleetName
from app.cli.output import say
from app.cli.service import fleet_session

if TYPE_CHECKING:
    from sqlalchemy.orm import Session


def reprocess(
    cars: Annotated[
        list[str] | None, typer.Argument(help="Identifiers of cars; without any, all of the fleet.")
    ] = None,
    fleet: FleetName = None,
    data: Data = None,
    as_json: AsJson = False,
) -> None:
    """Run the trips of cars again.

    As after an update: stages whose input, configuration and code are what they were keep their results.
    """
    from app.cars import service
    from app.trips import service as trips

    with fleet_session(data, fleet) as session:
        chosen = [service.get(session, car_id).id for car_id in cars] if cars else [*car_ids(session)]
        ids = [job.id for car_id in chosen for job in trips.reprocess_car(session, car_id)]
    say({"job_ids": ids}, as_json, f"{len(ids)} trips of {len(chosen)} cars will be run again")


def car_ids(session: Session) -> Iterator[str]:
    """Give the identifiers of all cars of the session's fleet."""
    from app.cars import service

    cursor: str | None = None
    while True:
        page = service.page(session, cursor)
        yield from (car.id for car in page.items)
        cursor = page.next_cursor
        if cursor is None:
            return
