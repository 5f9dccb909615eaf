"""The virtual car's engine: a known efficiency map, a full-load curve, idling and overrun."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import ScienceError
from app.science.virtualcar.kernels import engine_fuel_power

RADPS_PER_RPM = np.pi / 30.0
TABLE_4_1_PHI = (9.4360, -0.018136, -0.068797, 3.7201e-06, 2.1965e-05, 3.6204e-04)


def _smart_full_load() -> tuple[tuple[float, float], ...]:
    return (
        (800.0, 40.0), (1000.0, 52.0), (1500.0, 68.0), (2000.0, 85.0), (2500.0, 97.0), (3000.0, 104.0),
        (3500.0, 108.0), (4500.0, 110.0), (5250.0, 109.0), (5800.0, 97.0), (6200.0, 78.0),
    )  # fmt: skip


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
    """What the engine burns and what it can give.

    Fuel power is ω T φ(ω, T) with the polynomial of Sebesta 2010, Table 4.1 (order 1, ω, T, ωT, ω², T²; rad/s and Nm),
    or comes from a table, bilinear between its points, extended linearly below its lowest torque and held at its
    edges elsewhere. It never falls below ``idle_fuel_power_w``, which the polynomial lacks; above 2 kW of brake power
    that floor is not reached. Table 4.1 bounds no torque either: ``full_load`` does.

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
    full_load: tuple[tuple[float, float], ...] = field(default_factory=_smart_full_load)
    idle_fuel_power_w: float = 3500.0
    drag_nm: float = 5.0
    drag_nm_per_radps: float = 0.014
    fuel_cut_rpm: float = 1300.0

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
        if fuel_gps.shape != (len(rpm), len(nm)) or full_load_nm.shape != rpm.shape:
            raise ScienceError("The fuel table needs one row per engine speed and one column per torque.")
        if np.any(np.diff(rpm) <= 0) or np.any(np.diff(nm) <= 0) or nm[0] <= 0:
            raise ScienceError("The fuel table's engine speeds and torques must increase, torques from above zero.")
        if not (np.all(np.isfinite(fuel_gps)) and np.all(np.isfinite(full_load_nm))):
            raise ScienceError("The fuel table holds a number that is not finite.")
        power = fuel_gps * heating_value_jpg
        return cls(
            table=FuelTable(
                tuple(float(x) for x in rpm),
                tuple(float(x) for x in nm),
                tuple(tuple(float(x) for x in row) for row in power),
            ),
            full_load=tuple((float(r), float(t)) for r, t in zip(rpm, full_load_nm, strict=True)),
            idle_fuel_power_w=idle_fuel_power_w,
        )

    def full_load_nm(self, rpm: FloatArray) -> FloatArray:
        """Largest torque at the given engine speeds (rpm), Nm; same shape."""
        points = np.array(self.full_load)
        return np.asarray(np.interp(rpm, points[:, 0], points[:, 1]))

    def fuel_power_w(self, engine_speed_radps: FloatArray, torque_nm: FloatArray) -> FloatArray:
        """Fuel power at operating points, W; arguments broadcast."""
        omega, torque = np.broadcast_arrays(
            np.asarray(engine_speed_radps, dtype=np.float64), np.asarray(torque_nm, dtype=np.float64)
        )
        phi, table_omega, table_nm, table_w = self.kernel_arrays()
        flat = [
            engine_fuel_power(float(w), float(t), phi, table_omega, table_nm, table_w, self.idle_fuel_power_w)
            for w, t in zip(omega.ravel(), torque.ravel(), strict=True)
        ]
        return np.array(flat).reshape(omega.shape)

    def map_efficiency(self, rpm: FloatArray, nm: FloatArray) -> FloatArray:
        """Known efficiency at engine speeds (rpm) and torques (Nm); NaN above full load; arguments broadcast."""
        omega = np.asarray(rpm, dtype=np.float64) * RADPS_PER_RPM
        torque = np.asarray(nm, dtype=np.float64)
        efficiency = omega * torque / self.fuel_power_w(omega, torque)
        return np.where(torque <= self.full_load_nm(np.asarray(rpm, dtype=np.float64)), efficiency, np.nan)

    def kernel_arrays(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return φ, then the table's ω (rad/s), torques (Nm) and fuel power (W); empty where φ is used."""
        if self.table is None:
            return np.array(self.phi), np.empty(0), np.empty(0), np.empty((0, 0))
        omega = np.array(self.table.rpm) * RADPS_PER_RPM
        return np.array(self.phi), omega, np.array(self.table.nm), np.array(self.table.fuel_power_w)
