"""Cars as the API shows them: the row, what its XML says, what its trips add up to, its newest map."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.orm import Session

from app.batteries import service as batteries
from app.cars import service
from app.cars.models import Car
from app.cars.schemas import CarDocument, FieldDocument, FormDocument, LatestMap, VehicleDocument
from app.maps import service as maps
from app.trips import service as trips


def cars(session: Session, rows: Sequence[Car]) -> list[CarDocument]:
    """Return the documents of cars."""
    ids = [car.id for car in rows]
    readings = service.readings(session, rows)
    totals = trips.totals_of_cars(session, ids)
    latest = maps.latest_of_cars(session, ids)
    battery_ids = batteries.ids_of_cars(session, ids)
    documents = []
    for car in rows:
        reading, total, newest = readings[car.id], totals[car.id], latest.get(car.id)
        documents.append(
            CarDocument(
                id=car.id,
                name=car.name,
                title=car.title,
                config_sha256=car.config_sha256,
                config_revision=car.revision,
                load_kg=car.load_kg,
                vehicle=VehicleDocument.model_validate(reading.vehicle),
                warnings=list(reading.warnings),
                defaulted=list(reading.defaulted),
                unknown=list(reading.unknown),
                trip_count=total.trip_count,
                distance_m=total.distance_m,
                fuel_l=total.fuel_l,
                litres_per_100km=total.litres_per_100km,
                latest_map=None if newest is None else LatestMap.model_validate(newest),
                battery_ids=battery_ids[car.id],
                created_at=car.created_at,
                updated_at=car.updated_at,
            )
        )
    return documents


def car(session: Session, row: Car) -> CarDocument:
    """Return the document of one car."""
    return cars(session, [row])[0]


def form(session: Session, car_id: str) -> FormDocument:
    """Return a car's form."""
    fields = [
        FieldDocument(
            path=field.path,
            label=field.label,
            unit=field.unit,
            help=field.help,
            kind=field.kind,
            value=value,
            default=field.default,
            minimum=field.minimum,
            maximum=field.maximum,
            choices=list(field.choices),
            group=field.group,
        )
        for field, value in service.form(session, car_id)
    ]
    return FormDocument(fields=fields)
