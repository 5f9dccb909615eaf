"""What an injector pulse stands for, worked out here rather than shared with what reads the pulses."""

from __future__ import annotations

from math import pi

from app.science.vehicle.model import Vehicle


def angle_per_pulse_rad(vehicle: Vehicle) -> float:
    """Engine angle between two logged pulses (Sebesta 2010, 2.3.4.1), rad."""
    pulses_per_cycle = {
        "sequential": 1,
        "grouped": vehicle.injection.groups,
        "simultaneous": vehicle.cylinders,
    }
    return 4.0 * pi / pulses_per_cycle[vehicle.injection.pattern]


def open_power_w(vehicle: Vehicle) -> float:
    """Fuel energy per second that one logged pulse stands for while the injector is open, W.

    ``litres_per_second`` is the flow of all injectors together. A sequential pulse stands for the pulses of all
    cylinders in its cycle, a grouped one for those of its group.
    """
    groups = vehicle.injection.groups if vehicle.injection.pattern == "grouped" else 1
    return vehicle.injection.litres_per_second * vehicle.fuel_energy_j_per_l / groups
