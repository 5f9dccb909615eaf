"""What the engine gives at the wheels, as a linear model of what it burns or of the torque it reports."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.roadload.windows import Regime, RoadLoadWindows
from app.science.vehicle.model import Vehicle

Model = Literal["fuel", "torque"]

DEGREE = 5
"""Of the polynomial in engine speed and fuel power; on virtual cars degree 3 left 17 % of bias in C_rr."""
FREE_SD, CURVED_SD, TIGHTER = 3.0, 2.0, 0.7
"""Priors of the polynomial in parts of the rated power: constant and slopes are free, higher degrees ever tighter."""
DRIVELINE, DRIVELINE_SD = 0.95, 0.5
"""Share of the reported torque that reaches the wheels; deliberately open, since it is what tells the mass."""
FRICTION_SD = 0.1
"""Of an offset in the reported torque, in parts of the rated torque."""
POWER_PER_LITRE_W, POWER_W, POWER_RPM, TORQUE_NM = 50e3, 80e3, 5500.0, 150.0
"""Ratings of an engine of which the file says nothing; they only scale the polynomial."""
BEST_EFFICIENCY = 0.33

ROAD = 2
"""The last columns: drag and rolling resistance, each relative to what the car's file says."""
DRAG, ROLLING = -2, -1


@dataclass(frozen=True, slots=True)
class Terms:
    """Linear model of the specific force of `RoadLoadWindows`.

    f = Σ β_k φ_k(ω, u) P_0 / (M_0 v) − δ (D_0/M_0) v² − γ C_0 (g cos θ + S_k v²), with u the fuel power or the reported
    torque. δ is D/M over the file's, γ is C_rr over the file's; the mass itself scales both sides and drops out.

    Attributes
    ----------
    model : {"fuel", "torque"}
    powers : tuple of (int, int)
        Exponents of the scaled engine speed and of ``u``.
    mean, sd : array, shape (p,)
        Prior of the engine's coefficients; the road's entries are left to `app.science.roadload.identify`.
    speed_middle_radps, speed_half_radps, input_middle, input_half, reference_w : float
        Scales.
    mass_kg, drag_area_kgpm, crr : float
        Of the car's file.
    """

    model: Model
    powers: tuple[tuple[int, int], ...]
    mean: FloatArray
    sd: FloatArray
    speed_middle_radps: float
    speed_half_radps: float
    input_middle: float
    input_half: float
    reference_w: float
    mass_kg: float
    drag_area_kgpm: float
    crr: float

    @property
    def size(self) -> int:
        """Number of columns p."""
        return len(self.powers) + ROAD

    @property
    def is_highest(self) -> BoolArray:
        """Which of the p coefficients are the polynomial's of highest degree; none where torque is reported."""
        highest = [self.model == "fuel" and i + j == DEGREE for i, j in self.powers]
        return np.array([*highest, *[False] * ROAD])

    def columns(self, windows: RoadLoadWindows) -> FloatArray:
        """Return the design, shape (n, p); with an open clutch the engine has no part in it."""
        omega = windows.engine_speed_radps
        x = (omega - self.speed_middle_radps) / self.speed_half_radps
        lead = self.reference_w / (self.mass_kg * windows.speed_mps)
        if self.model == "fuel":
            inputs = (windows.fuel_power_w - self.input_middle) / self.input_half
        else:
            inputs = windows.torque_nm / self.input_half
            lead = lead * omega / (self.speed_middle_radps + self.speed_half_radps)
        engaged = windows.kind != Regime.COAST
        engine = [np.where(engaged, x**i * inputs**j * lead, 0.0) for i, j in self.powers]
        drag = -self.drag_area_kgpm / self.mass_kg * windows.speed_squared_m2ps2
        return np.column_stack([*engine, drag, -self.crr * windows.normal_mps2])


def terms_of(vehicle: Vehicle, model: Model) -> Terms:
    """Return the model's terms with scales from the car's file alone, so that trips can be added up."""
    by_size = vehicle.displacement_l * POWER_PER_LITRE_W if vehicle.displacement_l else POWER_W
    power = vehicle.max_power_w or by_size
    idle, highest = vehicle.idle_rpm * pi / 30.0, 1.1 * (vehicle.max_power_rpm or POWER_RPM) * pi / 30.0
    if model == "fuel":
        powers = tuple((i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i))
        degree = np.array([i + j for i, j in powers])
        mean = np.zeros(len(powers))
        sd = np.where(degree <= 1, FREE_SD, CURVED_SD * TIGHTER ** (degree - 2.0))
        reference = power
        middle = half = 0.5 * power / BEST_EFFICIENCY
    else:
        powers = ((0, 1), (0, 0), (1, 0))
        torque = vehicle.max_torque_nm or TORQUE_NM
        reference, middle, half = torque * highest, 0.0, torque
        mean, sd = np.array([DRIVELINE, 0.0, 0.0]), np.array([DRIVELINE_SD, FRICTION_SD, FRICTION_SD])
    return Terms(
        model=model,
        powers=powers,
        mean=mean,
        sd=sd,
        speed_middle_radps=0.5 * (idle + highest),
        speed_half_radps=0.5 * (highest - idle),
        input_middle=middle,
        input_half=half,
        reference_w=reference,
        mass_kg=vehicle.mass_kg,
        drag_area_kgpm=vehicle.drag_area_kgpm,
        crr=vehicle.crr,
    )
