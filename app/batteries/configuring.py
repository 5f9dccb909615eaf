"""What a battery is made of, as its car's XML says it: read for the estimators, written back as a new revision."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import Conflict
from app.science.battery.config import BatteryConfig
from app.science.battery.config_reading import config_document, read_config
from app.science.vehicle.battery import BatterySpec
from app.science.vehicle.battery_document import battery_document
from app.science.vehicle.battery_xml import with_battery
from app.storage.keys import stage_key

CELL = ("ocv", "ocv_soc_range", "initial", "series", "parallel", "temperature", "hysteresis", "initial_sd")
"""Fields of a configuration that say what a cell is; with others of them, nothing is carried over."""


@dataclass(frozen=True, slots=True)
class BatteryInForce:
    """A car's battery as its file has it.

    Attributes
    ----------
    spec : BatterySpec
    revision : int
        Of the car's file.
    document : dict
        The configuration as the file says it.
    """

    spec: BatterySpec
    revision: int
    document: dict[str, Any]

    def config(self) -> BatteryConfig:
        """Return the configuration as estimators take it; raises `ProblemError` where something is missing."""
        return read_config(self.document)


def in_force(session: Session, car_id: str) -> BatteryInForce:
    """Return a car's battery; raises `NotFound` for no car, `Conflict` for a car whose file has no battery any more."""
    car = cars.config(session, car_id)
    if car.vehicle.battery is None:
        message = "The car's file has no <battery> any more. Put one in, or PUT a configuration here, which does that."
        raise Conflict("no-battery-in-file", message)
    return BatteryInForce(car.vehicle.battery, car.revision, battery_document(car.vehicle.battery))


def put_in_force(
    session: Session,
    car_id: str,
    document: dict[str, Any],
    *,
    name: str | None = None,
    end_of_life: float | None = None,
) -> BatteryInForce:
    """Write a configuration into a car's file as a new revision; what is the same already stays as it is.

    Raises
    ------
    NotFound
        When there is no such car.
    ProblemError
        With the path of what is wrong in the configuration.
    """
    read_config(document)
    xml = cars.config(session, car_id, lock=True).xml
    changed = with_battery(xml, document, name=name, end_of_life=end_of_life)
    cars.replace_config(session, car_id, changed, "Battery configured")
    return in_force(session, car_id)


def named(session: Session, car_id: str, *, name: str | None, end_of_life: float | None) -> BatteryInForce:
    """Write a battery's name and end of life into its car's file; what is None stays. Raises as `in_force` does."""
    found = in_force(session, car_id)
    xml = cars.config(session, car_id, lock=True).xml
    changed = with_battery(xml, found.document, name=name, end_of_life=end_of_life)
    cars.replace_config(session, car_id, changed, "Battery renamed" if name is not None else "Battery's end of life")
    return in_force(session, car_id)


def taken_out(session: Session, car_id: str) -> None:
    """Write the car's file without a battery."""
    xml = cars.config(session, car_id, lock=True).xml
    cars.replace_config(session, car_id, with_battery(xml, None), "Battery taken out")


def config_key(config: BatteryConfig) -> str:
    """Return the name of a configuration."""
    return stage_key("battery-config", document=config_document(config))


def cell_key(config: BatteryConfig) -> str:
    """Return the name of what a configuration says of the cell, whatever the estimator and how it is set."""
    document = config_document(config)
    return stage_key("battery-cell", document={name: document.get(name) for name in CELL})
