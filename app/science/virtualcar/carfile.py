"""The virtual car's XML, in the form of Sebesta 2010, App. C.1.2."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from app.science.vehicle.model import Vehicle

_GEAR_NAMES = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth")


def car_xml(vehicle: Vehicle, tyre: str = "205/45 R16") -> bytes:
    """Write a car as ``<ponthy_config>``.

    Parameters
    ----------
    vehicle : Vehicle
    tyre : str
        Tyre code from which a reader gets the wheel radius.
    """
    mounting, injection = vehicle.mounting, vehicle.injection
    gears = "\n".join(
        f'    <{name} gear="{ratio!r}" />' for name, ratio in zip(_GEAR_NAMES, vehicle.gear_ratios, strict=False)
    )
    displacement = f"{vehicle.displacement_l * 1000:.0f}cc" if vehicle.displacement_l else ""
    return f"""<?xml version="1.0" encoding="UTF-8" ?>
<ponthy_config>
  <car>
    <owner owner={quoteattr(vehicle.owner)} />
    <make make={quoteattr(vehicle.make)} />
    <model model={quoteattr(vehicle.model)} />
    <year year={quoteattr(vehicle.year)} />
    <color color={quoteattr(vehicle.color)} />
  </car>
  <engine>
    <type type={quoteattr(vehicle.engine_type)} />
    <displacement displacement="{displacement}" />
    <power power="{_at(vehicle.max_power_w, 1e-3, "kW", vehicle.max_power_rpm)}" />
    <torque torque="{_at(vehicle.max_torque_nm, 1.0, "Nm", vehicle.max_torque_rpm)}" />
    <idle rpm="{vehicle.idle_rpm:g}" />
    <inertia lumped="{vehicle.engine_inertia_kgm2!r}" />
  </engine>
  <wheels>
    <tire summer={quoteattr(tyre)} />
    <inertia lumped="{vehicle.wheel_inertia_kgm2!r}" />
    <!--Inertia PER wheel/tire assembly-->
  </wheels>
  <accelerometer type="LIS3LV02DL">
    <calibration>
      <roll phi="{mounting.roll_rad!r}" />
      <pitch theta="{mounting.pitch_rad!r}" />
      <yaw psi="{mounting.yaw_rad!r}" />
      <scale scale="{mounting.scale!r}" />
    </calibration>
  </accelerometer>
  <transmission type="{len(vehicle.gear_ratios)}-spd sequential">
    <!--Total ratios between the engine and the wheel axle-->
    <reverse gear="" />
{gears}
  </transmission>
  <drag>
    <aero Cd="{vehicle.cd!r}" />
    <rolling Crr="{vehicle.crr!r}" />
  </drag>
  <area frontal="{vehicle.frontal_area_m2!r}" />
  <mass wet="{vehicle.mass_wet_kg!r}" />
  <inj>
    <calibration fuelPerSecond="{injection.litres_per_second!r}" />
    <calibration lag="{injection.lag_s!r}" />
    <timing pattern={quoteattr(injection.pattern)} />
  </inj>
  <vss>
    <calibration metersPerTick="{vehicle.vss_m_per_tick!r}" />
  </vss>
  <file Name="trip.dat" />
</ponthy_config>
""".encode()


def _at(value: float | None, factor: float, unit: str, rpm: float | None) -> str:
    if value is None:
        return ""
    return f"{value * factor:g}{unit}" + (f" @{rpm:g}rpm" if rpm is not None else "")
