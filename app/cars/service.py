"""Cars and their XML: what the other slices may ask of a car, and what the API does with one."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from sqlalchemy.orm import Session

from app.cars import repository
from app.cars.models import Car, CarConfigRevision
from app.errors import Invalid, NotFound
from app.science.vehicle.fields import FIELDS, Field, FormError, apply_form, form_values
from app.science.vehicle.model import Vehicle
from app.science.vehicle.xml import VehicleReading, config_fingerprint, examine_vehicle, new_car_xml
from app.storage.base import now
from app.storage.paging import DEFAULT_LIMIT, Page

DEFAULT_LOAD_KG = 75.0
"""Driver and things, as in Sebesta 2010."""

Value = float | str


@dataclass(frozen=True, slots=True)
class CarConfig:
    """A car as the science needs it.

    Attributes
    ----------
    car_id : str
    xml : bytes
        The file in force.
    revision : int
        Its number.
    sha256 : str
        Its fingerprint.
    vehicle : Vehicle
        What it says, with the car's load.
    key : str
        Hash of everything of the car that a result depends on: the fingerprint and the load.
    """

    car_id: str
    xml: bytes
    revision: int
    sha256: str
    vehicle: Vehicle
    key: str


def get(session: Session, car_id: str) -> Car:
    """Return a car; raises `NotFound`."""
    found = repository.car(session, car_id)
    if found is None:
        raise NotFound("car", car_id)
    return found


def names(session: Session, car_ids: Sequence[str]) -> dict[str, str]:
    """Return the names of cars by identifier."""
    return {car.id: car.name for car in repository.cars_with_ids(session, car_ids)}


def config(session: Session, car_id: str, *, lock: bool = False) -> CarConfig:
    """Return a car's configuration in force; with ``lock`` nobody else takes or changes it until the transaction ends.

    Raises
    ------
    NotFound
        When there is no such car.
    """
    car = repository.car(session, car_id, lock=lock)
    if car is None:
        raise NotFound("car", car_id)
    xml = repository.configs_in_force(session, [car_id])[car_id]
    key = hashlib.sha256(f"{car.config_sha256} {car.load_kg!r}".encode()).hexdigest()
    return CarConfig(car.id, xml, car.revision, car.config_sha256, reading(xml, car.load_kg).vehicle, key)


@lru_cache(maxsize=256)
def reading(xml: bytes, load_kg: float) -> VehicleReading:
    """Return what a car's XML says; remembered, because lists ask for the same cars again and again."""
    return examine_vehicle(xml, load_kg=load_kg)


def create(session: Session, *, xml: bytes | None = None, name: str | None = None) -> Car:
    """Make a car from its XML; without one it begins with an empty file, where defaults stand in for everything.

    Raises
    ------
    VehicleConfigError
        When the XML can't be used.
    """
    text = new_car_xml() if xml is None else xml
    title = reading(text, DEFAULT_LOAD_KG).vehicle.title
    fingerprint = config_fingerprint(text)
    car = Car(name=name or title, title=title, revision=1, config_sha256=fingerprint, load_kg=DEFAULT_LOAD_KG)
    session.add(car)
    session.flush()
    session.add(CarConfigRevision(car_id=car.id, number=1, sha256=fingerprint, xml=text))
    session.flush()
    _tell_of_battery(session, car, text)
    return car


def page(session: Session, cursor: str | None = None, limit: int = DEFAULT_LIMIT) -> Page[Car]:
    """Return one page of the fleet's cars, newest first."""
    return repository.cars(session, cursor, limit)


def readings(session: Session, cars: Sequence[Car]) -> dict[str, VehicleReading]:
    """Return what the XML of each car says, by identifier."""
    files = repository.configs_in_force(session, [car.id for car in cars])
    return {car.id: reading(files[car.id], car.load_kg) for car in cars}


def change(session: Session, car_id: str, *, name: str | None, load_kg: float | None) -> Car:
    """Change a car's name or load; what is None stays. Raises `NotFound`."""
    car = get(session, car_id)
    car.name = car.name if name is None else name
    car.load_kg = car.load_kg if load_kg is None else load_kg
    car.updated_at = now()
    return car


def replace_config(session: Session, car_id: str, xml: bytes, note: str = "") -> Car:
    """Put a new XML in force and keep the old one; the very same bytes change nothing.

    ``note`` says where it came from.

    Raises
    ------
    NotFound
        When there is no such car.
    VehicleConfigError
        When the XML can't be used.
    """
    car = _locked(session, car_id)
    title = reading(xml, car.load_kg).vehicle.title
    if repository.configs_in_force(session, [car_id])[car_id] == xml:
        return car
    car.revision += 1
    car.config_sha256 = config_fingerprint(xml)
    car.title = title
    car.updated_at = now()
    session.add(CarConfigRevision(car_id=car.id, number=car.revision, sha256=car.config_sha256, xml=xml, note=note))
    session.flush()
    _tell_of_battery(session, car, xml)
    return car


def _tell_of_battery(session: Session, car: Car, xml: bytes) -> None:
    from app.batteries import service as batteries  # which stands on this module

    batteries.notice(session, car.id, car.name, car.revision, reading(xml, car.load_kg).vehicle.battery)


def restore_config(session: Session, car_id: str, number: int) -> Car:
    """Put an older XML in force again, as a new revision; raises `NotFound`."""
    return replace_config(session, car_id, config_xml(session, car_id, number), f"Revision {number} again")


def _locked(session: Session, car_id: str) -> Car:
    car = repository.car(session, car_id, lock=True)
    if car is None:
        raise NotFound("car", car_id)
    return car


def config_xml(session: Session, car_id: str, number: int | None = None) -> bytes:
    """Return a car's XML, the one in force or an older one; raises `NotFound`."""
    car = get(session, car_id)
    found = repository.revision(session, car_id, car.revision if number is None else number)
    if found is None:
        raise NotFound("revision", str(number))
    return found.xml


def revisions(session: Session, car_id: str, cursor: str | None, limit: int) -> Page[CarConfigRevision]:
    """Return all versions of a car's XML, newest first; raises `NotFound`."""
    get(session, car_id)
    return repository.revisions(session, car_id, cursor, limit)


def form(session: Session, car_id: str) -> list[tuple[Field, Value | None]]:
    """Return the form's fields in order, each with its value; raises `NotFound`."""
    values = form_values(config_xml(session, car_id))
    return [(field, values[field.path]) for field in FIELDS]


def fill_form(session: Session, car_id: str, values: Mapping[str, Value | None], note: str = "") -> Car:
    """Write the form's values into the car's XML and put it in force; ``note`` says where they came from.

    Raises
    ------
    NotFound
        When there is no such car.
    Invalid
        With what is wrong in which field.
    """
    _locked(session, car_id)
    try:
        after = apply_form(config_xml(session, car_id), values)
    except FormError as error:
        raise Invalid("bad-car-form", str(error), element=error.element, fields=error.fields) from error
    return replace_config(session, car_id, after, note)


def delete(session: Session, car_id: str) -> None:
    """Remove a car with its files' rows; the caller has seen to its trips. Raises `NotFound`."""
    session.delete(get(session, car_id))
