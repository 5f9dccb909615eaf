"""Operating points: what the engine did at a moment at which it propelled the car."""

from __future__ import annotations

from dataclasses import dataclass

from app.science.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class OperatingPoints:
    """Operating points of one trip, every array of shape (n,).

    Attributes
    ----------
    t_s : array
    engine_speed_rpm, torque_nm : array
    power_w : array
        Mechanical power, above the propelling threshold.
    fuel_power_w : array
    efficiency, efficiency_sd : array
        Ratio of the two and its standard deviation, as fractions of 1.
    torque_source : str
        ``observer`` (thrust times speed over engine speed) or ``ecu`` (torque the engine reported).
    """

    t_s: FloatArray
    engine_speed_rpm: FloatArray
    torque_nm: FloatArray
    power_w: FloatArray
    fuel_power_w: FloatArray
    efficiency: FloatArray
    efficiency_sd: FloatArray
    torque_source: str

    def __len__(self) -> int:
        return len(self.t_s)
