"""Bodies of the cars' requests and answers."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, Field

from app.schemas import Document, Moment, Name

CAR_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "name": "Grey roadster",
    "title": "Smart Roadster 2004",
    "config_sha256": "9c6f0c2f6d0b6d3f3a6a0c1f5f0f0a9c8d7e6f5a4b3c2d1e0f9a8b7c6d5e4f3a",
    "config_revision": 3,
    "load_kg": 75.0,
    "vehicle": {
        "make": "Smart",
        "model": "Roadster",
        "year": "2004",
        "color": "grey",
        "engine_type": "Inline 3",
        "displacement_l": 0.698,
        "cylinders": 3,
        "max_power_w": 60000.0,
        "max_power_rpm": 5250.0,
        "max_torque_nm": 110.0,
        "max_torque_rpm": 4500.0,
        "idle_rpm": 850.0,
        "fuel_name": "petrol",
        "mass_kg": 919.0,
        "cd": 0.39,
        "crr": 0.0125,
        "frontal_area_m2": 1.93,
        "wheel_radius_m": 0.2954,
        "gear_ratios": [13.25, 9.604, 7.37, 5.796, 4.208, 3.23],
        "vss_m_per_tick": 0.270184,
        "speed_scale": 1.0,
    },
    "warnings": [],
    "defaulted": ["chassis/inertia@roll"],
    "unknown": [],
    "trip_count": 14,
    "distance_m": 812000.0,
    "fuel_l": 41.4,
    "litres_per_100km": 5.1,
    "latest_map": {
        "version": 14,
        "cells": 912,
        "trusted_cells": 636,
        "points": 1204511,
        "trips": 14,
        "best": {"efficiency": 0.38, "rpm": 3850.0, "nm": 93.0, "sd": 0.012},
        "created_at": "2026-03-01T08:12:00Z",
    },
    "battery_ids": ["6f1c2f0b8d8e4a0f9a52f1b6c0de0021"],
    "created_at": "2026-02-27T18:40:00Z",
    "updated_at": "2026-03-01T08:00:00Z",
}


class VehicleDocument(Document):
    """The numbers of the XML in SI units, with defaults where it is silent."""

    make: str
    model: str
    year: str
    color: str
    engine_type: str
    displacement_l: float | None
    cylinders: int
    max_power_w: float | None
    max_power_rpm: float | None
    max_torque_nm: float | None
    max_torque_rpm: float | None
    idle_rpm: float
    fuel_name: str
    mass_kg: float = Field(description="Car, driver and things.")
    cd: float
    crr: float
    frontal_area_m2: float
    wheel_radius_m: float
    gear_ratios: list[float] = Field(description="Total ratios engine to wheel, first gear first.")
    vss_m_per_tick: float
    speed_scale: float = Field(description="True speed per measured speed, for logs without wheel ticks.")


class BestPoint(Document):
    """The most efficient trusted cell of a map."""

    efficiency: float
    rpm: float
    nm: float
    sd: float | None


class LatestMap(Document):
    """The newest efficiency map of a car, in short."""

    version: int
    cells: int
    trusted_cells: int
    points: int
    trips: int
    best: BestPoint | None
    created_at: Moment


class CarDocument(Document):
    """A car, what it is and what it has done."""

    model_config = ConfigDict(json_schema_extra={"example": CAR_EXAMPLE})

    id: str
    name: str
    title: str = Field(description="Make, model and year, from the XML.")
    config_sha256: str = Field(description="Fingerprint of the XML: equal for files that mean the same.")
    config_revision: int
    load_kg: float = Field(description="Driver and things, which the XML's mass leaves out.")
    vehicle: VehicleDocument
    warnings: list[str] = Field(description="What is odd about the XML, but possible.")
    defaulted: list[str] = Field(description="Values the science uses and the XML leaves open.")
    unknown: list[str] = Field(description="What the XML says besides; it is kept, not used.")
    trip_count: int
    distance_m: float
    fuel_l: float
    litres_per_100km: float | None
    latest_map: LatestMap | None
    battery_ids: list[str]
    created_at: Moment
    updated_at: Moment


class NewCar(Document):
    """A car to be made."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"name": "Grey roadster"}})

    name: Name | None = None
    config_xml: str | None = Field(None, max_length=1_000_000, description="The car's XML; left out: an empty one.")


class CarChange(Document):
    """What is to be changed of a car; what is left out stays."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"name": "Grey roadster", "load_kg": 90}})

    name: Name | None = None
    load_kg: float | None = Field(None, ge=0, le=50_000, allow_inf_nan=False)


class RevisionDocument(Document):
    """One version of a car's XML."""

    number: int
    sha256: str
    note: str = Field(description="Where it came from, if not from hand.")
    created_at: Moment


class FieldDocument(Document):
    """One field of the car's form."""

    path: str
    label: str
    unit: str
    help: str
    kind: str
    value: float | str | None
    default: float | str | None = Field(description="What is used while the value is empty.")
    minimum: float | None
    maximum: float | None
    choices: list[str]
    group: str


FIELD_EXAMPLE: dict[str, Any] = {
    "path": "drag/aero@Cd",
    "label": "Drag coefficient",
    "unit": "",
    "help": "Of the whole car, with what is on its roof.",
    "kind": "number",
    "value": 0.39,
    "default": 0.39,
    "minimum": 0.0,
    "maximum": 2.0,
    "choices": [],
    "group": "Resistance",
}


class FormDocument(Document):
    """The car's form."""

    model_config = ConfigDict(json_schema_extra={"example": {"fields": [FIELD_EXAMPLE]}})

    fields: list[FieldDocument]


class FormValues(Document):
    """Values typed into the form, by path; null or an empty text empties one."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"values": {"drag/aero@Cd": 0.39, "car/color@color": "grey"}}}
    )

    values: dict[str, float | str | None]
