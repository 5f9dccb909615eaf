"""What the science knows of a car: the numbers of its XML in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

from app.science.arrays import FloatArray
from app.science.vehicle.battery import BatterySpec

STANDARD_GRAVITY_MPS2 = 9.80665
PETROL_ENERGY_J_PER_L = 32.0e6
PETROL_DENSITY_KG_PER_L = 0.745


INJECTION_DOUBTS: Mapping[str, str] = {
    "direct": "The engine injects directly: its fuel pressure changes with load, so the length of a pulse does not "
    "tell the fuel, and efficiency is doubtful. Log the engine control unit's fuel rate (fuel_rate_lph) instead.",
    "dual": "The engine has a second group of injectors that comes in with load: the pulses of one group do not tell "
    "all of the fuel, and efficiency is doubtful. Log the engine control unit's fuel rate (fuel_rate_lph) instead.",
}
"""What is to be said of pulses as a measure of fuel, by `Injection.system`."""


@dataclass(frozen=True, slots=True)
class Mounting:
    """How the accelerometer sits in the car (Sebesta 2010, App. C.1.2).

    ``body = scale · Rz(yaw) · Ry(pitch) · Rx(roll) · sensor`` with body axes forward, right, down.
    """

    roll_rad: float = 0.0
    pitch_rad: float = 0.0
    yaw_rad: float = 0.0
    scale: float = 1.0

    @property
    def matrix(self) -> FloatArray:
        """Rotation times scale, shape (3, 3)."""
        cr, sr = np.cos(self.roll_rad), np.sin(self.roll_rad)
        cp, sp = np.cos(self.pitch_rad), np.sin(self.pitch_rad)
        cy, sy = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        rotation = np.array(
            [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ]
        )
        return self.scale * rotation


@dataclass(frozen=True, slots=True)
class Injection:
    """Fuel injectors as the logger sees them (Sebesta 2010, 2.3.4 and App. C.1.2).

    Attributes
    ----------
    litres_per_second : float
        Flow of *all* injectors together while open, l/s.
    lag_s : float
        Added to the length of the voltage pulse to get the real opening time; usually negative.
    pattern : str
        ``sequential``, ``grouped`` or ``simultaneous``.
    groups : int
        Number of injector groups where the pattern is ``grouped``.
    system : str
        ``port``, ``direct``, or ``dual`` where a second group of injectors comes in with load; pulse lengths tell the
        fuel of ``port`` alone.
    """

    litres_per_second: float = 0.008
    lag_s: float = -0.0004
    pattern: str = "sequential"
    groups: int = 1
    system: str = "port"


@dataclass(frozen=True, slots=True)
class Vehicle:
    """A car, with defaults of Sebesta 2010, Table 3.1 (Smart Roadster) wherever its XML is silent.

    ``gear_ratios`` are total ratios from engine to wheel, first gear first. ``mass_wet_kg`` is the car alone with all
    fluids; ``load_kg`` is the driver and things. ``speed_scale`` makes a speed measured as such the true one.
    """

    owner: str = ""
    make: str = ""
    model: str = ""
    year: str = ""
    color: str = ""
    engine_type: str = ""
    displacement_l: float | None = None
    max_power_w: float | None = None
    max_power_rpm: float | None = None
    max_torque_nm: float | None = None
    max_torque_rpm: float | None = None
    compression_ratio: float | None = None
    cylinders: int = 3
    idle_rpm: float = 850.0
    engine_inertia_kgm2: float = 0.061
    tyre: str = ""
    wheel_radius_m: float = 0.2954
    wheel_inertia_kgm2: float = 0.62
    accelerometer_type: str = ""
    mounting: Mounting = field(default_factory=Mounting)
    transmission_type: str = ""
    gear_ratios: tuple[float, ...] = ()
    reverse_ratio: float | None = None
    cd: float = 0.39
    crr: float = 0.0125
    frontal_area_m2: float = 1.93
    mass_wet_kg: float = 844.0
    load_kg: float = 75.0
    injection: Injection = field(default_factory=Injection)
    vss_m_per_tick: float = 0.270183975491887
    speed_scale: float = 1.0
    fuel_name: str = "petrol"
    fuel_energy_j_per_l: float = PETROL_ENERGY_J_PER_L
    fuel_density_kg_per_l: float = PETROL_DENSITY_KG_PER_L
    air_density_kgpm3: float = 1.2
    gravity_mps2: float = 9.805
    battery: BatterySpec | None = None
    files: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Make, model and year in one line."""
        return " ".join(part for part in (self.make, self.model, self.year) if part) or "Unnamed car"

    @property
    def mass_kg(self) -> float:
        """Total mass M: car, driver and things, kg."""
        return self.mass_wet_kg + self.load_kg

    def accelerated_mass_kg(self, gear: int) -> float:
        """Accelerated mass M_a in a gear, kg; gear 0 is neutral or an open clutch.

        Sebesta 2010 after (1.4) counts the wheels only; the drivetrain's inertia, seen through the gear, is added
        here, because without it thrust is up to 13 % low in first gear.
        """
        mass = self.mass_kg + 4.0 * self.wheel_inertia_kgm2 / self.wheel_radius_m**2
        if 1 <= gear <= len(self.gear_ratios):
            mass += self.engine_inertia_kgm2 * (self.gear_ratios[gear - 1] / self.wheel_radius_m) ** 2
        return mass

    @property
    def drag_area_kgpm(self) -> float:
        """½ ρ C_d A, kg/m."""
        return 0.5 * self.air_density_kgpm3 * self.cd * self.frontal_area_m2

    @property
    def engine_angle_per_pulse_rad(self) -> float:
        """Engine angle between two injector pulses, rad (Sebesta 2010, 2.3.4.1)."""
        per_cycle = {"sequential": 1, "grouped": self.injection.groups, "simultaneous": self.cylinders}
        return 4.0 * pi / per_cycle[self.injection.pattern]

    def fuel_energy_of_pulse_j(self, duration_s: FloatArray) -> FloatArray:
        """Fuel energy of injector pulses of the given lengths, J; never negative.

        A sequential pulse of one injector stands for all cylinders of one cycle, a simultaneous one for all injectors
        at once, a grouped one for its own group.
        """
        share = 1.0 / self.injection.groups if self.injection.pattern == "grouped" else 1.0
        open_s = np.maximum(duration_s + self.injection.lag_s, 0.0)
        return np.asarray(open_s * self.injection.litres_per_second * share * self.fuel_energy_j_per_l)
