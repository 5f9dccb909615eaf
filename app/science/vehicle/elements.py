"""The elements of ``<ponthy_config>`` (Sebesta 2010, App. C.1.2): one table for reading, writing and the form.

Units and limits stand here and nowhere else. Not in the thesis' sample, but saying what it leaves to the reader, are
``wheels/radius``, ``inj/system``, ``fuel``, ``inj/timing@groups``, ``vss/calibration@speedScale`` and ``battery``.
"""

from __future__ import annotations

from dataclasses import replace

from app.science.vehicle import quantities as q
from app.science.vehicle.battery_elements import GROUPS as BATTERY_GROUPS
from app.science.vehicle.element_kinds import GEARS, angle, gear, number, rating, text
from app.science.vehicle.field import Field
from app.science.vehicle.fuels import FUELS

PATTERNS = ("sequential", "grouped", "simultaneous")
SYSTEMS = ("port", "direct", "dual")

_GROUPS: dict[str, tuple[Field, ...]] = {
    "Car": (
        text("car/owner@owner", "owner", "Owner", "Whose car it is."),
        text("car/make@make", "make", "Make", "The maker, for example Smart."),
        text("car/model@model", "model", "Model", "For example Roadster."),
        text("car/year@year", "year", "Year", "Model year."),
        text("car/color@color", "color", "Colour", "Only to tell cars apart."),
    ),
    "Engine": (
        Field(
            "engine/type@type",
            "Engine",
            "In words; the number of cylinders is read from it: Inline 3, V6, 4 cyl.",
            "engine_type",
            form="engine",
        ),
        number(
            "engine/displacement@displacement",
            "displacement_l",
            "Displacement",
            q.VOLUME,
            (0.02, 30.0),
            (0.2, 16.0),
            "Swept volume. Both 0.698 and 698cc are understood.",
        ),
        rating("power", "max_power_w", q.POWER, (0.5, 2000.0), "60kW @5250rpm", 1000.0),
        rating("torque", "max_torque_nm", q.TORQUE, (1.0, 10000.0), "110Nm @4500rpm"),
        number(
            "engine/compression@comp",
            "compression_ratio",
            "Compression",
            q.RATIO,
            (3.0, 40.0),
            (7.0, 24.0),
            "Compression ratio: 9:1 or 9.",
        ),
        number(
            "engine/idle@rpm",
            "idle_rpm",
            "Idle speed",
            q.SPEED,
            (100.0, 3000.0),
            (400.0, 1500.0),
            "Engine speed when warm and idling.",
        ),
        number(
            "engine/inertia@lumped",
            "engine_inertia_kgm2",
            "Drivetrain inertia",
            q.INERTIA,
            (0.0, 20.0),
            (0.005, 5.0),
            "Everything that turns with the engine, without wheels and tyres.",
        ),
    ),
    "Wheels": (
        Field(
            "wheels/tire@summer",
            "Tyre",
            "The code on the tyre's side, 205/45 R16; the wheel's radius follows from it.",
            "tyre",
            form="tyre",
        ),
        number(
            "wheels/radius@m",
            "wheel_radius_m",
            "Wheel radius",
            q.LENGTH,
            (0.1, 1.2),
            (0.2, 0.6),
            "Measured rolling radius. Leave it empty to take the tyre's nominal one.",
            follows="wheels/tire@summer",
        ),
        number(
            "wheels/inertia@lumped",
            "wheel_inertia_kgm2",
            "Wheel inertia",
            q.INERTIA,
            (0.0, 100.0),
            (0.05, 20.0),
            "Of one wheel with its tyre.",
        ),
    ),
    "Sensors": (
        text("accelerometer@type", "accelerometer_type", "Accelerometer", "Which sensor is built in."),
        angle("roll", "phi"),
        angle("pitch", "theta"),
        angle("yaw", "psi"),
        number(
            "accelerometer/calibration/scale@scale",
            "mounting.scale",
            "Accelerometer scale",
            q.COUNT,
            (0.5, 2.0),
            (0.9, 1.1),
            "Factor that makes the sensor read 1 g at rest.",
        ),
        number(
            "vss/calibration@metersPerTick",
            "vss_m_per_tick",
            "Distance per tick",
            q.DISTANCE_PER_TICK,
            (1e-4, 100.0),
            (0.005, 5.0),
            "How far the car rolls from one tick of the wheel-speed sensor to the next.",
        ),
        number(
            "vss/calibration@speedScale",
            "speed_scale",
            "Speed scale",
            q.COUNT,
            (0.5, 2.0),
            (0.9, 1.1),
            "True speed over the one that a log without ticks tells: 0.99 where it reads 1 % high. Empty: 1.",
            follows="vss/calibration@metersPerTick",
        ),
    ),
    "Transmission": (
        text("transmission@type", "transmission_type", "Transmission", "In words: 6-spd sequential."),
        number(
            "transmission/reverse@gear",
            "reverse_ratio",
            "Reverse gear",
            q.RATIO,
            (0.1, 100.0),
            (1.5, 40.0),
            "Turns of the engine per turn of the wheel, as for the other gears.",
        ),
        *(gear(index) for index in range(len(GEARS))),
    ),
    "Resistance": (
        number(
            "drag/aero@Cd", "cd", "Drag coefficient", q.COUNT, (0.0, 2.0), (0.1, 1.2), "Coefficient of air resistance."
        ),
        number(
            "drag/rolling@Crr",
            "crr",
            "Rolling resistance",
            q.COUNT,
            (0.0, 0.1),
            (0.004, 0.03),
            "Coefficient of rolling resistance.",
        ),
        number(
            "area@frontal",
            "frontal_area_m2",
            "Frontal area",
            q.AREA,
            (0.1, 20.0),
            (0.8, 11.0),
            "Largest cross-section as seen from the front.",
        ),
        number(
            "mass@wet",
            "mass_wet_kg",
            "Mass",
            q.MASS,
            (50.0, 60000.0),
            (300.0, 40000.0),
            "The car alone with all its fluids; driver and things come on top.",
        ),
    ),
    "Fuel": (
        number(
            "inj/calibration@fuelPerSecond",
            "injection.litres_per_second",
            "Injector flow",
            q.FLOW,
            (1e-5, 2.0),
            (0.001, 0.2),
            "Litres per second of all injectors together while open. 480 cc/min is understood too.",
        ),
        number(
            "inj/calibration@lag",
            "injection.lag_s",
            "Injector lag",
            q.TIME,
            (-0.02, 0.02),
            (-0.003, 0.001),
            "Added to the length of the voltage pulse to get the opening time; usually negative.",
        ),
        Field(
            "inj/timing@pattern",
            "Injection timing",
            "Each injector by itself, in groups, or all at once.",
            "injection.pattern",
            "choice",
            choices=PATTERNS,
        ),
        Field(
            "inj/timing@groups",
            "Injector groups",
            "How many groups take turns, where the timing is grouped.",
            "injection.groups",
            "number",
            q.COUNT,
            minimum=1.0,
            maximum=16.0,
            form="whole",
            follows="inj/timing@pattern",
        ),
        Field(
            "inj/system@type",
            "Injection",
            "Into the port, directly into the cylinder, or dual: a second group of injectors comes in with load. "
            "Pulses tell the fuel of port injection alone.",
            "injection.system",
            "choice",
            choices=SYSTEMS,
        ),
        Field(
            "fuel@type",
            "Fuel",
            "What is in the tank; sets energy and density unless they are given.",
            "fuel_name",
            "choice",
            choices=tuple(FUELS),
            form="fuel",
        ),
        number(
            "fuel@energy",
            "fuel_energy_j_per_l",
            "Fuel energy",
            q.ENERGY_DENSITY,
            (5.0, 50.0),
            (20.0, 40.0),
            "Lower heating value. Empty: the published value of the fuel.",
            1e6,
            "fuel@type",
        ),
        number(
            "fuel@density",
            "fuel_density_kg_per_l",
            "Fuel density",
            q.DENSITY,
            (0.3, 1.5),
            (0.5, 0.9),
            "At 15 °C. Empty: the published value of the fuel.",
            follows="fuel@type",
        ),
    ),
    **BATTERY_GROUPS,
}

FIELDS: tuple[Field, ...] = tuple(replace(field, group=name) for name, fields in _GROUPS.items() for field in fields)
"""Every value of the file that Ponthy reads, in the order of the form."""
FIELD_OF: dict[str, Field] = {field.path: field for field in FIELDS}
