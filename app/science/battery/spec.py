"""Between the battery of a car's XML and the configuration of an estimate."""

from __future__ import annotations

from app.science.battery.config import BatteryConfig
from app.science.battery.config_reading import config_document, read_config
from app.science.vehicle.battery import BatterySpec
from app.science.vehicle.battery_document import battery_document, spec_of_document

__all__ = ["config_of_spec", "spec_of_config"]


def config_of_spec(spec: BatterySpec) -> BatteryConfig:
    """Return the configuration of an estimate for a car's battery.

    Raises
    ------
    ProblemError
        Naming the first field that is missing or can't be.
    """
    return read_config(battery_document(spec))


def spec_of_config(config: BatteryConfig) -> BatterySpec:
    """Return a configuration as a car's XML holds it, without name and with the usual end of life."""
    return spec_of_document(config_document(config))
