"""The virtual car's engine: a known efficiency map, a full-load curve, idling and overrun."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import ScienceError
from app.science.vehicle.model import Vehicle
from app.science.virtualcar.injection import angle_per_pulse_rad, open_power_w
from app.science.virtualcar.kernels import FuelNumbers, fuel_powers

RADPS_PER_RPM = pi / 30.0
TABLE_4_1_PHI = (9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04)
SMART_FULL_LOAD = (
    (800.0, 40.0),
    (1000.0, 52.0),
    (1500.0, 68.0),
    (2000.0, 85.0),
    (2500.0, 97.0),
    (3000.0, 104.0),
    (3500.0, 108.0),
    (4500.0, 110.0),
    (5250.0, 109.1),
    (5800.0, 97.0),
    (6200.0, 78.0),
)
LONGEST_PULSE_S = 0.99 * 0xFFFF * 250e-9


@dataclass(frozen=True, slots=True)
class FuelTable:
    """Fuel power over engine speed and torque on a full grid.

    Attributes
    ----------
    rpm : tuple of float, length n
        Strictly increasing engine speeds, rpm.
    nm : tuple of float, length m
        Strictly increasing torques above zero, Nm.
    fuel_power_w : tuple of tuples, n by m
        Energy content of the fuel burned per second, W.
    """

    rpm: tuple[float, ...]
    nm: tuple[float, ...]
    fuel_power_w: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class EngineModel:
    """What the engine burns and what it can give; the defaults are the Smart's of Sebesta 2010.

    Fuel power is ω T φ(ω, T) with the polynomial of Table 4.1 (order 1, ω, T, ωT, ω², T²; rad/s and Nm), or comes from
    a table. It never falls below ``idle_fuel_power_w``, which the polynomial lacks; with any brake power worth a place
    in a map that floor is not reached. Table 4.1 bounds no torque either: ``full_load`` does (110 Nm at 4500 rpm and
    60 kW at 5250 rpm as in App. C.1.2).

    Attributes
    ----------
    phi : tuple of 6 floats
        Used where ``table`` is None.
    table : FuelTable or None
    full_load : tuple of (rpm, Nm)
        Largest torque by engine speed, linear between the points.
    idle_fuel_power_w : float
        Fuel power while idling or turning without load, W.
    drag_nm, drag_nm_per_radps : float
        Torque that turns the engine on overrun, with no fuel: ``drag_nm + drag_nm_per_radps · ω``.
    fuel_cut_rpm : float
        Overrun above this speed gets no fuel.
    """

    phi: tuple[float, ...] = TABLE_4_1_PHI
    table: FuelTable | None = None
    full_load: tuple[tuple[float, float], ...] = SMART_FULL_LOAD
    idle_fuel_power_w: float = 3500.0
    drag_nm: float = 5.0
    drag_nm_per_radps: float = 0.014
    fuel_cut_rpm: float = 1300.0

    @classmethod
    def for_vehicle(cls, vehicle: Vehicle) -> EngineModel:
        """Stretch the Smart's engine to the torque and power that a car is rated at.

        The map keeps its shape over torque and engine speed relative to the ratings. Where a rating is not known, the
        Smart's holds.
        """
        torque_rating, power_rating_rpm = 110.0, 5250.0
        stretch = (vehicle.max_torque_nm or torque_rating) / torque_rating
        faster = (vehicle.max_power_rpm or power_rating_rpm) / power_rating_rpm
        at_power = stretch
        if vehicle.max_power_w is not None and vehicle.max_power_rpm is not None:
            at_power = vehicle.max_power_w / (vehicle.max_power_rpm * RADPS_PER_RPM) / 109.135
        full_load = tuple(
            (rpm * faster, nm * float(np.interp(rpm, [4500.0, power_rating_rpm], [stretch, at_power])))
            for rpm, nm in SMART_FULL_LOAD
        )
        c = TABLE_4_1_PHI
        return cls(
            phi=(c[0], c[1] / faster, c[2] / stretch, c[3] / (faster * stretch), c[4] / faster**2, c[5] / stretch**2),
            full_load=full_load,
            idle_fuel_power_w=3500.0 * stretch,
            drag_nm=5.0 * stretch,
            drag_nm_per_radps=0.014 * stretch / faster,
            fuel_cut_rpm=1300.0 * vehicle.idle_rpm / 850.0,
        )

    @classmethod
    def from_fuel_rate(
        cls,
        rpm: FloatArray,
        nm: FloatArray,
        fuel_gps: FloatArray,
        full_load_nm: FloatArray,
        *,
        heating_value_jpg: float = 42600.0,
        idle_fuel_power_w: float = 3500.0,
    ) -> EngineModel:
        """Build an engine from a measured fuel table.

        Parameters
        ----------
        rpm : array, shape (n,)
            Engine speeds, rpm, strictly increasing.
        nm : array, shape (m,)
            Torques, Nm, strictly increasing and positive.
        fuel_gps : array, shape (n, m)
            Fuel rate, g/s. Entries above full load may be padding: torque never goes there.
        full_load_nm : array, shape (n,)
            Largest torque at each engine speed, Nm.
        heating_value_jpg : float
            Lower heating value of the fuel, J/g.
        idle_fuel_power_w : float
            Fuel power while idling, W.

        Raises
        ------
        ScienceError
            When the shapes disagree, an axis is not increasing, or a number is not finite.
        """
        if min(len(rpm), len(nm)) < 2 or fuel_gps.shape != (len(rpm), len(nm)) or full_load_nm.shape != rpm.shape:
            raise ScienceError(
                f"A fuel table of shape {fuel_gps.shape} doesn't fit {len(rpm)} engine speeds and {len(nm)} torques: "
                "give one row per engine speed and one column per torque, at least two of each."
            )
        if np.any(np.diff(rpm) <= 0) or np.any(np.diff(nm) <= 0) or nm[0] <= 0:
            raise ScienceError("The fuel table's engine speeds and torques must increase, torques from above zero.")
        if not (np.all(np.isfinite(fuel_gps)) and np.all(np.isfinite(full_load_nm))):
            raise ScienceError("The fuel table holds a number that is not finite; leave padding as large numbers.")
        power = fuel_gps * heating_value_jpg
        return cls(
            table=FuelTable(tuple(rpm.tolist()), tuple(nm.tolist()), tuple(tuple(row) for row in power.tolist())),
            full_load=tuple(zip(rpm.tolist(), full_load_nm.tolist(), strict=True)),
            idle_fuel_power_w=idle_fuel_power_w,
        )

    def limited_by_injectors(self, vehicle: Vehicle) -> EngineModel:
        """Return the engine with its full load lowered to what the car's injectors can deliver.

        A pulse can't be longer than the logger's 16 bits of 250 ns hold. An engine that stays below is
        returned as it is.
        """
        speeds = np.arange(self.full_load[0][0], self.full_load[-1][0] + 1.0, 50.0)
        torques = self.full_load_nm(speeds)
        omega = speeds * RADPS_PER_RPM
        capacity_j = open_power_w(vehicle) * (LONGEST_PULSE_S + vehicle.injection.lag_s)
        most_w = capacity_j / angle_per_pulse_rad(vehicle) * omega
        too_much = self.fuel_power_w(omega, torques) > most_w
        if not np.any(too_much):
            return self
        low, high = np.zeros_like(torques), torques.copy()
        for _ in range(40):
            middle = 0.5 * (low + high)
            fits = self.fuel_power_w(omega, middle) <= most_w
            low, high = np.where(fits, middle, low), np.where(fits, high, middle)
        torques = np.where(too_much, low, torques)
        return replace(self, full_load=tuple(zip(speeds.tolist(), torques.tolist(), strict=True)))

    def full_load_nm(self, rpm: FloatArray) -> FloatArray:
        """Largest torque at the given engine speeds (rpm), Nm; same shape."""
        points = np.array(self.full_load)
        return np.asarray(np.interp(rpm, points[:, 0], points[:, 1]))

    def fuel_power_w(self, engine_speed_radps: FloatArray, torque_nm: FloatArray) -> FloatArray:
        """Fuel power at operating points, W; arguments broadcast."""
        omega, torque = np.broadcast_arrays(
            np.asarray(engine_speed_radps, dtype=np.float64), np.asarray(torque_nm, dtype=np.float64)
        )
        power = fuel_powers(omega.ravel(), torque.ravel(), self.fuel_numbers())
        return power.reshape(omega.shape)

    def map_efficiency(self, rpm: FloatArray, nm: FloatArray) -> FloatArray:
        """Known efficiency at engine speeds (rpm) and torques (Nm); NaN above full load; arguments broadcast."""
        speed = np.asarray(rpm, dtype=np.float64)
        torque = np.asarray(nm, dtype=np.float64)
        omega = speed * RADPS_PER_RPM
        efficiency = omega * torque / self.fuel_power_w(omega, torque)
        return np.where(torque <= self.full_load_nm(speed), efficiency, np.nan)

    def fuel_numbers(self) -> FuelNumbers:
        """Return the fuel part as the kernels take it."""
        phi = np.array(self.phi)
        if self.table is None:
            return FuelNumbers(phi, np.empty(0), np.empty(0), np.empty((0, 0)), self.idle_fuel_power_w)
        omega = np.array(self.table.rpm) * RADPS_PER_RPM
        return FuelNumbers(
            phi, omega, np.array(self.table.nm), np.array(self.table.fuel_power_w), self.idle_fuel_power_w
        )
