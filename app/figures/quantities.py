"""How each quantity is shown: words, unit, scale and decimals."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from app.science.arrays import FloatArray
from app.science.logger.recording import SIGNAL_UNITS


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity as people read it.

    Attributes
    ----------
    label : str
    unit : str
        Of the shown number; empty for a plain number.
    factor : float
        Shown number = SI value times this.
    decimals : int
    stepped : bool
        Changes in jumps.
    """

    label: str
    unit: str
    factor: float = 1.0
    decimals: int = 2
    stepped: bool = False

    @property
    def title(self) -> str:
        """Label and unit, as an axis says it."""
        return f"{self.label}, {self.unit}" if self.unit else self.label

    def shown(self, value: FloatArray) -> FloatArray:
        """Scale SI values to the shown unit."""
        return value * self.factor


DEGREES = 180.0 / pi

QUANTITIES: dict[str, Quantity] = {
    "distance_m": Quantity("Distance", "km", 1e-3, 3),
    "speed_mps": Quantity("Speed", "km/h", 3.6, 2),
    "thrust_n": Quantity("Thrust", "kN", 1e-3, 3),
    "heading_rad": Quantity("Heading", "°", DEGREES, 1),
    "pitch_rad": Quantity("Pitch", "°", DEGREES, 2),
    "north_m": Quantity("North", "m", 1.0, 1),
    "east_m": Quantity("East", "m", 1.0, 1),
    "down_m": Quantity("Down", "m", 1.0, 1),
    "curvature_h_radpm": Quantity("Curvature", "1/km", 1e3, 2),
    "curvature_v_radpm": Quantity("Vertical curvature", "1/km", 1e3, 3),
    "fuel_energy_j": Quantity("Fuel burnt", "MJ", 1e-6, 3),
    "fuel_power_w": Quantity("Fuel power", "kW", 1e-3, 2),
    "engine_angle_rad": Quantity("Engine turns", "turns", 0.5 / pi, 1),
    "engine_speed_radps": Quantity("Engine speed", "rpm", 30.0 / pi, 0),
    "bias_i_mps2": Quantity("Bias forward", "m/s²", 1.0, 4),
    "bias_j_mps2": Quantity("Bias right", "m/s²", 1.0, 4),
    "bias_k_mps2": Quantity("Bias down", "m/s²", 1.0, 4),
    "lat_deg": Quantity("Latitude", "°", 1.0, 6),
    "lon_deg": Quantity("Longitude", "°", 1.0, 6),
    "alt_m": Quantity("Altitude", "m", 1.0, 1),
    "torque_nm": Quantity("Torque", "Nm", 1.0, 1),
    "power_w": Quantity("Power", "kW", 1e-3, 2),
    "efficiency": Quantity("Efficiency", "%", 100.0, 1),
    "gear": Quantity("Gear", "", 1.0, 0, stepped=True),
}
"""Every column of the states table but the time."""


def quantity(name: str) -> Quantity:
    """Return how a column or signal is shown; one that is not in the table is shown as it is."""
    known = QUANTITIES.get(name)
    return known or Quantity(name, SIGNAL_UNITS.get(name, ""), 1.0, 4)
