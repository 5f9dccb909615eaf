"""Cars around measured engines, for finding their maps again from driving.

The engines' fuel tables are NREL's, as CSV with the columns ``rpm``, ``torque_nm``, ``fuel_g_s`` and
``max_torque_nm_at_rpm``; cells above the largest torque are padding.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.science.vehicle.model import Injection, Mounting, Vehicle
from app.science.virtualcar.engine import EngineModel

PETROL_JPG, DIESEL_JPG = 42600.0, 42940.0
MOUNTING = Mounting(0.3, -0.1, 2.0, 1.01)


@dataclass(frozen=True, slots=True)
class EngineCar:
    """An engine's table, and a car that it could be in; inertias, gears and resistance are typical of its class."""

    table: str
    heating_value_jpg: float
    idle_fuel_power_w: float
    vehicle: Vehicle

    @property
    def name(self) -> str:
        """How tables call it."""
        return f"{self.vehicle.make} {self.vehicle.displacement_l:.1f} L"

    def engine(self, folder: Path) -> EngineModel:
        """Read the engine from the folder of tables."""
        with (folder / f"{self.table}.csv").open(newline="") as file:
            rows = [{name: float(text) for name, text in row.items() if text} for row in csv.DictReader(file)]
        rpm = sorted({row["rpm"] for row in rows})
        nm = sorted({row["torque_nm"] for row in rows if row["torque_nm"] > 0.0})
        fuel = {(row["rpm"], row["torque_nm"]): row["fuel_g_s"] for row in rows}
        most = {row["rpm"]: row["max_torque_nm_at_rpm"] for row in rows}
        return EngineModel.from_fuel_rate(
            np.array(rpm),
            np.array(nm),
            np.array([[fuel[speed, torque] for torque in nm] for speed in rpm]),
            np.array([most[speed] for speed in rpm]),
            heating_value_jpg=self.heating_value_jpg,
            idle_fuel_power_w=self.idle_fuel_power_w,
        )


ENGINE_CARS = (
    EngineCar(
        "geo_1.0L_SI_41kW",
        PETROL_JPG,
        2600.0,
        Vehicle(
            make="Geo",
            engine_type="Inline 3",
            displacement_l=0.993,
            max_power_w=41e3,
            max_power_rpm=5700.0,
            max_torque_nm=80.9,
            max_torque_rpm=3477.0,
            engine_inertia_kgm2=0.07,
            wheel_radius_m=0.2667,
            wheel_inertia_kgm2=0.5,
            gear_ratios=(15.0, 8.31, 5.62, 4.01, 3.32),
            cd=0.34,
            frontal_area_m2=1.75,
            crr=0.0105,
            mass_wet_kg=760.0,
            injection=Injection(litres_per_second=0.0085),
            mounting=MOUNTING,
        ),
    ),
    EngineCar(
        "insight_1.0L_VTEC-E",
        PETROL_JPG,
        2800.0,
        Vehicle(
            make="Honda",
            engine_type="Inline 3",
            displacement_l=0.995,
            max_power_w=50e3,
            max_power_rpm=6000.0,
            max_torque_nm=90.8,
            max_torque_rpm=4582.0,
            engine_inertia_kgm2=0.08,
            wheel_radius_m=0.283,
            wheel_inertia_kgm2=0.5,
            gear_ratios=(11.9, 6.62, 4.44, 3.42, 2.68),
            cd=0.25,
            frontal_area_m2=1.9,
            crr=0.0085,
            mass_wet_kg=838.0,
            injection=Injection(litres_per_second=0.0085),
            mounting=MOUNTING,
        ),
    ),
    EngineCar(
        "prius_jpn_1.5L_43kW",
        PETROL_JPG,
        3500.0,
        Vehicle(
            make="Toyota",
            engine_type="Inline 4",
            displacement_l=1.497,
            max_power_w=43e3,
            max_power_rpm=4000.0,
            max_torque_nm=102.0,
            max_torque_rpm=4000.0,
            cylinders=4,
            engine_inertia_kgm2=0.1,
            wheel_radius_m=0.283,
            wheel_inertia_kgm2=0.6,
            gear_ratios=(11.9, 6.62, 4.44, 3.42, 2.68),
            cd=0.29,
            frontal_area_m2=2.16,
            crr=0.0085,
            mass_wet_kg=1240.0,
            injection=Injection(litres_per_second=0.0095),
            mounting=MOUNTING,
        ),
    ),
    EngineCar(
        "saturn_1.9L_DOHC_95kW",
        PETROL_JPG,
        5000.0,
        Vehicle(
            make="Saturn",
            engine_type="Inline 4",
            displacement_l=1.901,
            max_power_w=95e3,
            max_power_rpm=6000.0,
            max_torque_nm=165.4,
            max_torque_rpm=4500.0,
            cylinders=4,
            idle_rpm=800.0,
            engine_inertia_kgm2=0.12,
            wheel_radius_m=0.299,
            wheel_inertia_kgm2=0.8,
            gear_ratios=(13.2, 8.29, 5.38, 3.86, 2.85),
            cd=0.33,
            frontal_area_m2=2.0,
            crr=0.010,
            mass_wet_kg=1080.0,
            injection=Injection(litres_per_second=0.018),
            mounting=MOUNTING,
        ),
    ),
    EngineCar(
        "vw_1.9L_TDI_ORNL",
        DIESEL_JPG,
        3500.0,
        Vehicle(
            make="VW",
            engine_type="Inline 4",
            displacement_l=1.896,
            max_power_w=66e3,
            max_power_rpm=4000.0,
            max_torque_nm=217.0,
            max_torque_rpm=1900.0,
            cylinders=4,
            idle_rpm=900.0,
            engine_inertia_kgm2=0.15,
            wheel_radius_m=0.303,
            wheel_inertia_kgm2=0.9,
            gear_ratios=(12.8, 7.1, 4.6, 3.25, 2.5),
            cd=0.32,
            frontal_area_m2=2.08,
            crr=0.009,
            mass_wet_kg=1250.0,
            injection=Injection(litres_per_second=0.02),
            fuel_name="diesel",
            fuel_energy_j_per_l=36e6,
            fuel_density_kg_per_l=0.835,
            mounting=MOUNTING,
        ),
    ),
)
