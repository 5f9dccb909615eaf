"""The virtual car's XML, in the form of Sebesta 2010, App. C.1.2."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from app.science.vehicle.model import Vehicle

_GEARS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def car_xml(vehicle: Vehicle) -> bytes:
    """Write a car as ``<ponthy_config>``; what the thesis has no element for is added only where it is needed."""
    mounting, injection = vehicle.mounting, vehicle.injection
    gears = [f"<{name} gear={_number(ratio)} />" for name, ratio in zip(_GEARS, vehicle.gear_ratios, strict=False)]
    groups = f' groups="{injection.groups}"' if injection.pattern == "grouped" else ""
    fuel = [] if vehicle.fuel_name == "petrol" else [f"<fuel type={quoteattr(vehicle.fuel_name)} />"]
    lines = [
        '<?xml version="1.0" encoding="UTF-8" ?>',
        "<ponthy_config>",
        "  <car>",
        f"    <owner owner={quoteattr(vehicle.owner)} />",
        f"    <make make={quoteattr(vehicle.make)} />",
        f"    <model model={quoteattr(vehicle.model)} />",
        f"    <year year={quoteattr(vehicle.year)} />",
        f"    <color color={quoteattr(vehicle.color)} />",
        "  </car>",
        "  <engine>",
        f"    <type type={quoteattr(vehicle.engine_type)} />",
        f'    <displacement displacement="{_scaled(vehicle.displacement_l, 1000.0, "cc")}" />',
        f'    <power power="{_rated(vehicle.max_power_w, 1e-3, "kW", vehicle.max_power_rpm)}" />',
        f'    <torque torque="{_rated(vehicle.max_torque_nm, 1.0, "Nm", vehicle.max_torque_rpm)}" />',
        f'    <compression comp="{_scaled(vehicle.compression_ratio, 1.0, ":1")}" />',
        f"    <idle rpm={_number(vehicle.idle_rpm)} />",
        f"    <inertia lumped={_number(vehicle.engine_inertia_kgm2)} />",
        "  </engine>",
        "  <wheels>",
        *([f"    <tire summer={quoteattr(vehicle.tyre)} />"] if vehicle.tyre else []),
        *([] if vehicle.tyre else [f"    <radius m={_number(vehicle.wheel_radius_m)} />"]),
        f"    <inertia lumped={_number(vehicle.wheel_inertia_kgm2)} />",
        "    <!--Inertia of each wheel with its tyre-->",
        "  </wheels>",
        f"  <accelerometer type={quoteattr(vehicle.accelerometer_type)}>",
        "    <calibration>",
        f"      <roll phi={_number(mounting.roll_rad)} />",
        f"      <pitch theta={_number(mounting.pitch_rad)} />",
        f"      <yaw psi={_number(mounting.yaw_rad)} />",
        f"      <scale scale={_number(mounting.scale)} />",
        "    </calibration>",
        "  </accelerometer>",
        f"  <transmission type={quoteattr(vehicle.transmission_type)}>",
        "    <!--Total ratios between the engine and the wheel axle-->",
        f'    <reverse gear="{_scaled(vehicle.reverse_ratio, 1.0, "")}" />',
        *(f"    {gear}" for gear in gears),
        "  </transmission>",
        "  <drag>",
        f"    <aero Cd={_number(vehicle.cd)} />",
        f"    <rolling Crr={_number(vehicle.crr)} />",
        "  </drag>",
        f"  <area frontal={_number(vehicle.frontal_area_m2)} />",
        f"  <mass wet={_number(vehicle.mass_wet_kg)} />",
        "  <inj>",
        f"    <calibration fuelPerSecond={_number(injection.litres_per_second)} />",
        f"    <calibration lag={_number(injection.lag_s)} />",
        f"    <timing pattern={quoteattr(injection.pattern)}{groups} />",
        *([] if injection.system == "port" else [f"    <system type={quoteattr(injection.system)} />"]),
        "  </inj>",
        *(f"  {line}" for line in fuel),
        "  <vss>",
        f"    <calibration metersPerTick={_number(vehicle.vss_m_per_tick)} />",
        "  </vss>",
        '  <file Name="trip.dat" />',
        "</ponthy_config>",
        "",
    ]
    return "\n".join(lines).encode("utf-8")


def _number(value: float) -> str:
    return f'"{value!r}"'


def _scaled(value: float | None, factor: float, unit: str) -> str:
    return "" if value is None else f"{value * factor:g}{unit}"


def _rated(value: float | None, factor: float, unit: str, rpm: float | None) -> str:
    return _scaled(value, factor, unit) + ("" if value is None or rpm is None else f" @{rpm:g}rpm")
